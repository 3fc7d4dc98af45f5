#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "skeleton/gestures/gesture_recognizer.h"

namespace kino::fuzz {

/// Any bytes as gesture definitions: no crash, and what is accepted can be written, read back to
/// the same, and recognised with.
inline void gestures(std::span<const std::uint8_t> bytes) {
    const auto read =
        gestures_from_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzz");
    if (!read) return;
    const std::string text = gestures_to_json(*read);
    const auto again = gestures_from_json(text, "fuzz");
    KINO_CHECK(again.has_value());
    KINO_CHECK(gestures_to_json(*again) == text);
    KINO_CHECK(again->learned.size() == read->learned.size());
}

}  // namespace kino::fuzz
