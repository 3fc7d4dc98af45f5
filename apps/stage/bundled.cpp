#include "apps/stage/bundled.h"

#include <fmt/format.h>

#include "viz/scene/scene_file.h"

// The assembler pastes the files in; KINO_SCENES is their folder.
#define KINO_EMBED_SCENE(symbol, file)    \
    __asm__(                              \
        ".section .rodata\n"              \
        ".global kino_scene_" symbol      \
        "\n"                              \
        "kino_scene_" symbol              \
        ":\n"                             \
        ".incbin \"" KINO_SCENES "/" file \
        ".json\"\n"                       \
        ".global kino_scene_" symbol      \
        "_end\n"                          \
        "kino_scene_" symbol              \
        "_end:\n"                         \
        ".byte 0\n"                       \
        ".previous\n")

KINO_EMBED_SCENE("light_painting", "light-painting");
KINO_EMBED_SCENE("chair_room", "chair-room");
KINO_EMBED_SCENE("torch", "torch");
KINO_EMBED_SCENE("colonnade", "colonnade");
KINO_EMBED_SCENE("glass", "glass");
KINO_EMBED_SCENE("playroom", "playroom");
KINO_EMBED_SCENE("window", "window");

#define KINO_SCENE(name)                       \
    extern "C" const char kino_scene_##name[]; \
    extern "C" const char kino_scene_##name##_end[]

KINO_SCENE(light_painting);
KINO_SCENE(chair_room);
KINO_SCENE(torch);
KINO_SCENE(colonnade);
KINO_SCENE(glass);
KINO_SCENE(playroom);
KINO_SCENE(window);

namespace kino {

std::vector<BundledScene> bundled_scenes() {
    const auto text = [](const char* begin, const char* end) {
        return std::string_view(begin, static_cast<std::size_t>(end - begin));
    };
    return {{"light-painting", text(kino_scene_light_painting, kino_scene_light_painting_end)},
            {"chair-room", text(kino_scene_chair_room, kino_scene_chair_room_end)},
            {"torch", text(kino_scene_torch, kino_scene_torch_end)},
            {"colonnade", text(kino_scene_colonnade, kino_scene_colonnade_end)},
            {"glass", text(kino_scene_glass, kino_scene_glass_end)},
            {"playroom", text(kino_scene_playroom, kino_scene_playroom_end)},
            {"window", text(kino_scene_window, kino_scene_window_end)}};
}

std::optional<BundledScene> bundled_scene(std::string_view name) {
    for (const BundledScene& scene : bundled_scenes()) {
        if (scene.name == name) return scene;
    }
    return std::nullopt;
}

std::string list_of_scenes() {
    std::string text;
    for (const BundledScene& scene : bundled_scenes()) {
        const auto file = scene_file_from_json(scene.json, std::string(scene.name));
        text += fmt::format("  {:<16}{}\n", scene.name, file ? file->about : "");
    }
    return text;
}

}  // namespace kino
