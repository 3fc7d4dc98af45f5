#include "apps/avatar/bundled_rigs.h"

// The assembler pastes the file in; KINO_AVATARS is its folder.
__asm__(
    ".section .rodata\n"
    ".global kino_avatar_robot\n"
    "kino_avatar_robot:\n"
    ".incbin \"" KINO_AVATARS
    "/RobotExpressive.glb\"\n"
    ".global kino_avatar_robot_end\n"
    "kino_avatar_robot_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" const std::uint8_t kino_avatar_robot[];
extern "C" const std::uint8_t kino_avatar_robot_end[];

namespace kino {

std::vector<BundledRig> bundled_rigs() {
    return {{"robot",
             "RobotExpressive, a small robot of stiff parts (CC0)",
             {kino_avatar_robot, kino_avatar_robot_end}}};
}

}  // namespace kino
