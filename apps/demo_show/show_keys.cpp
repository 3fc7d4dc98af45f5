#include "apps/demo_show/show_keys.h"

#include <fmt/format.h>

#include <array>

#include "apps/demo_show/show_options.h"

namespace kino {
namespace {

// GLFW's codes of keys that are no letters.
constexpr int kSpace = 32, kEscape = 256;

constexpr std::array kShowKeys = {
    ShowKey{'H', "H", "show or hide these keys", ShowAction::help},
    ShowKey{kSpace, "Space", "pause, go on", ShowAction::pause},
    ShowKey{'N', "N", "next scene, as a swipe", ShowAction::next_scene},
    ShowKey{'R', "R", "record a session, end it", ShowAction::record},
    ShowKey{'F', "F", "whole screen, or a window", ShowAction::fullscreen},
    ShowKey{'O', "O", "times and quality on or off", ShowAction::stats},
    ShowKey{'P', "P", "picture into a PNG file", ShowAction::screenshot},
    ShowKey{kEscape, "Esc", "end", ShowAction::quit},
};

}  // namespace

std::span<const ShowKey> show_key_table() {
    return kShowKeys;
}

std::optional<ShowAction> show_action_of(int key) {
    for (const ShowKey& entry : kShowKeys) {
        if (entry.key == key) return entry.action;
    }
    return std::nullopt;
}

std::string show_keys_text() {
    std::string text;
    for (const ShowKey& entry : kShowKeys) {
        text += fmt::format("  {:<8} {}\n", entry.shown, entry.help);
    }
    return text;
}

}  // namespace kino
