#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "skeleton/gestures/gesture_json.h"

namespace kino::fuzz {

/// Any bytes as the detail of an event: no crash, and what is accepted is written and read back to
/// the same.
inline void gesture_event(std::span<const std::uint8_t> bytes) {
    const auto read = gesture_event_from_json(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzz");
    if (!read) return;
    const auto again = gesture_event_from_json(gesture_to_json(*read), "fuzz");
    KINO_CHECK(again.has_value() && *again == *read);
    KINO_CHECK(!gesture_text(*read).empty());
}

}  // namespace kino::fuzz
