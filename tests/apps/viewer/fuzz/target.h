#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "apps/viewer/budget_log.h"
#include "base/check.h"

namespace kino::fuzz {

/// Any bytes: refused, or levels that a frame can be drawn at, in order.
inline void budget_log(std::span<const std::uint8_t> bytes) {
    const auto log = parse_budget_log(
        std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), "fuzz");
    if (!log) return;
    std::int64_t before = -1;
    for (const FrameBudget::Logged& line : *log) {
        KINO_CHECK(line.frame > before);
        KINO_CHECK(line.lod >= 1 && line.lod <= 8);
        KINO_CHECK(line.zoom >= 1 && line.zoom <= 8);
        before = line.frame;
    }
}

}  // namespace kino::fuzz
