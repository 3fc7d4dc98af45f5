#include "skeleton/gestures/gesture_event.h"

#include <array>

namespace kino {
namespace {
constexpr std::array<std::string_view, kGestureKindCount> kNames = {
    "wave",  "swipe-left", "swipe-right", "swipe-up", "swipe-down",
    "push",  "raise",      "raise-both",  "zoom",     "rotate",
    "dwell", "t-pose",     "learned",     "engaged",  "released"};
}

std::string_view gesture_name(GestureKind kind) {
    return kNames[static_cast<std::size_t>(kind)];
}

std::optional<GestureKind> gesture_from_name(std::string_view name) {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (kNames[i] == name) return static_cast<GestureKind>(i);
    }
    return std::nullopt;
}

std::string_view hand_name(Hand hand) {
    constexpr std::array<std::string_view, 4> names = {"none", "left", "right", "both"};
    return names[static_cast<std::size_t>(hand)];
}

}  // namespace kino
