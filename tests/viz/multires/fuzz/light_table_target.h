#pragma once

#include <cstdint>
#include <span>

#include "base/check.h"
#include "viz/frame/learning/light_table.h"

namespace kino::fuzz {

/// Any bytes as a table of a scene's light: no crash, and what is accepted can be written, reads
/// back to the same and can be chosen from.
inline void light_table(std::span<const std::uint8_t> bytes) {
    const auto read =
        light_table_from_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzz");
    if (!read) {
        KINO_CHECK(!read.error().what.empty());
        return;
    }
    const auto again = light_table_from_json(light_table_to_json(*read), "again");
    KINO_CHECK(again.has_value());
    KINO_CHECK(*again == *read);
    const LightChoice choice = choose_rates(*read, 10);
    for (const double r : {choice.rates.shadowed, choice.rates.plain, choice.rates.bounced}) {
        KINO_CHECK(r == 0 || (r >= 1 && r <= 8));
    }
}

}  // namespace kino::fuzz
