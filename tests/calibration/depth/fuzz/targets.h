#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "calibration/depth_bias.h"

namespace kino::fuzz {

inline void depth_bias(std::span<const std::uint8_t> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto bias = bias_from_json(text, "", "fuzz");
    if (!bias) return;
    KINO_CHECK(bias->per_m.size() == static_cast<std::size_t>(bias->columns * bias->rows));
    const auto again = bias_from_json(bias_to_json(*bias, ""), "", "fuzz");
    KINO_CHECK(again.has_value() && *again == *bias);
    KINO_CHECK(std::abs(bias->at(bias->width - 1, 0)) <= 1);
}

}  // namespace kino::fuzz
