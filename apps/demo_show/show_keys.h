#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace kino {

enum class ShowAction : std::uint8_t {
    help,
    pause,
    next_scene,
    record,
    fullscreen,
    stats,
    screenshot,
    quit
};

struct ShowKey {
    int key = 0;  ///< GLFW's code
    const char* shown;
    const char* help;
    ShowAction action;
};
[[nodiscard]] std::span<const ShowKey> show_key_table();
[[nodiscard]] std::optional<ShowAction> show_action_of(int key);

}  // namespace kino
