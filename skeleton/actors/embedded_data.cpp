#include "skeleton/actors/embedded_data.h"

// The assembler pastes the files in; KINO_ACTOR_DATA is their folder.
#define KINO_EMBED(symbol, file)              \
    __asm__(                                  \
        ".section .rodata\n"                  \
        ".balign 16\n"                        \
        ".global kino_embedded_" symbol       \
        "\n"                                  \
        "kino_embedded_" symbol               \
        ":\n"                                 \
        ".incbin \"" KINO_ACTOR_DATA "/" file \
        "\"\n"                                \
        ".global kino_embedded_" symbol       \
        "_end\n"                              \
        "kino_embedded_" symbol               \
        "_end:\n"                             \
        ".byte 0\n"                           \
        ".previous\n")

KINO_EMBED("actor_body", "actor_body.bin");

extern "C" {
extern const std::byte kino_embedded_actor_body[];
extern const std::byte kino_embedded_actor_body_end[];
}

namespace kino {

std::span<const std::byte> actor_body_file() {
    return {kino_embedded_actor_body, kino_embedded_actor_body_end};
}

std::string_view actor_motion_file(std::string_view) {
    return {};
}

}  // namespace kino
