#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kino {

/// What a key does in the viewer.
enum class Action : std::uint8_t {
    pause,
    step_forward,
    step_back,
    faster,
    slower,
    normal_speed,
    next_loop_mode,
    to_start,
    next_source,
    toggle_style,
    larger_splats,
    smaller_splats,
    next_color_mode,
    sensor_view,
    orbit_view,
    fly_view,
    reset_camera,
    measure,
    screenshot,
    export_ply,
    record,
    toggle_controls,
    toggle_overlay,
    toggle_bodies,
    toggle_panes,
    toggle_help,
    quit
};

/// One key and its meaning; help texts are made of these, so they cannot lie.
struct KeyEntry {
    int key = 0;        ///< GLFW's code
    const char* shown;  ///< "Space"
    const char* help;   ///< "pause, go on"
    Action action;
    bool repeats = false;  ///< acts again while the key is held
};

[[nodiscard]] std::span<const KeyEntry> key_table();
/// Empty for keys without meaning, and for repeats of keys that act once.
[[nodiscard]] std::optional<Action> action_of(int key, bool repeat);
/// All keys and what the mouse does, a line each, for --help and the window.
[[nodiscard]] std::string keys_text();

/// What the mouse does and the keys that are held in flight, in the same form.
struct HelpLine {
    const char* shown;
    const char* help;
};
[[nodiscard]] std::span<const HelpLine> mouse_table();

}  // namespace kino
