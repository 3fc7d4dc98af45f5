#include "apps/viewer/keys.h"

#include <fmt/format.h>

#include <array>

namespace kino {
namespace {

// GLFW's codes of keys that are no letters; named here so that this room needs no window library.
constexpr int kSpace = 32;
constexpr int kEscape = 256;
constexpr int kRight = 262;
constexpr int kLeft = 263;
constexpr int kHome = 268;
constexpr int kF1 = 290;

constexpr std::array kKeys = {
    KeyEntry{kF1, "F1", "show or hide these keys", Action::toggle_help},
    KeyEntry{kSpace, "Space", "pause, go on", Action::pause},
    KeyEntry{kRight, "Right", "one frame forward, paused", Action::step_forward, true},
    KeyEntry{kLeft, "Left", "one frame back, paused", Action::step_back, true},
    KeyEntry{kHome, "Home", "to the first frame", Action::to_start},
    KeyEntry{'=', "+", "faster", Action::faster, true},
    KeyEntry{'-', "-", "slower", Action::slower, true},
    KeyEntry{'0', "0", "normal speed", Action::normal_speed},
    KeyEntry{'L', "L", "loop, ping-pong, once", Action::next_loop_mode},
    KeyEntry{'N', "N", "next recording", Action::next_source},
    KeyEntry{'1', "1", "view of the sensor", Action::sensor_view},
    KeyEntry{'2', "2", "view from an orbit", Action::orbit_view},
    KeyEntry{'3', "3", "fly", Action::fly_view},
    KeyEntry{'R', "R", "camera back to its start", Action::reset_camera},
    KeyEntry{'V', "V", "points or surface", Action::toggle_style},
    KeyEntry{']', "]", "larger points", Action::larger_splats, true},
    KeyEntry{'[', "[", "smaller points", Action::smaller_splats, true},
    KeyEntry{'C', "C", "colour: captured, mixed, relit", Action::next_color_mode},
    KeyEntry{'M', "M", "measure between two clicks", Action::measure},
    KeyEntry{'P', "P", "picture into a PNG file", Action::screenshot},
    KeyEntry{'X', "X", "points into a PLY file", Action::export_ply},
    KeyEntry{'K', "K", "record into a session, end it", Action::record},
    KeyEntry{'B', "B", "find bodies and gestures, or not", Action::toggle_bodies},
    KeyEntry{'T', "T", "knobs of the device: tilt, light, colour", Action::toggle_controls},
    KeyEntry{'O', "O", "text on or off", Action::toggle_overlay},
    KeyEntry{'I', "I", "images of the sensor on or off", Action::toggle_panes},
    KeyEntry{kEscape, "Esc", "end", Action::quit},
};

constexpr std::array kMouse = {
    HelpLine{"left drag", "turn (orbit), look around (fly)"},
    HelpLine{"right drag", "move sideways"},
    HelpLine{"wheel", "nearer, farther"},
    HelpLine{"W A S D Q E", "fly; Shift: faster"},
    HelpLine{"drop a folder", "plays it"},
};

}  // namespace

std::span<const KeyEntry> key_table() {
    return kKeys;
}
std::span<const HelpLine> mouse_table() {
    return kMouse;
}

std::optional<Action> action_of(int key, bool repeat) {
    for (const KeyEntry& entry : kKeys) {
        if (entry.key == key) {
            return repeat && !entry.repeats ? std::nullopt : std::optional(entry.action);
        }
    }
    return std::nullopt;
}

std::string keys_text() {
    std::string text;
    for (const KeyEntry& entry : kKeys)
        text += fmt::format("  {:<14} {}\n", entry.shown, entry.help);
    for (const HelpLine& line : kMouse) text += fmt::format("  {:<14} {}\n", line.shown, line.help);
    return text;
}

}  // namespace kino
