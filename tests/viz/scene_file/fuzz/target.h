#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/check.h"
#include "viz/scene/scene_file.h"

namespace kino::fuzz {

/// Any bytes as a scene file: no crash, and what is accepted keeps the limits, can be written and
/// reads back to the same.
inline void scene_file(std::span<const std::uint8_t> bytes) {
    const auto read =
        scene_file_from_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzz");
    if (!read) {
        KINO_CHECK(!read.error().what.empty());
        KINO_CHECK(read.error().where.starts_with("fuzz"));
        return;
    }
    KINO_CHECK(largest_count(*read).lights <= kMaxStageLights);
    KINO_CHECK(largest_count(*read).nodes <= kMaxStageNodes);
    const auto again = scene_file_from_json(scene_file_to_json(*read), "again");
    KINO_CHECK(again.has_value());
    KINO_CHECK(*again == *read);
}

}  // namespace kino::fuzz
