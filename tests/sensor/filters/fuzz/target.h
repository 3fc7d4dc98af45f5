#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "sensor/filters/depth_filter_chain.h"

namespace kino::fuzz {

/// What the parser promises for any bytes: no crash, errors that say something, and whatever it
/// accepts prints as text that means the same, and runs.
inline void filter_spec(std::span<const std::uint8_t> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    auto chain = DepthFilterChain::parse(text);
    if (!chain) {
        KINO_CHECK(!chain.error().what.empty() && !chain.error().where.empty());
        return;
    }
    const auto again = DepthFilterChain::parse(chain->specification());
    KINO_CHECK(again.has_value());
    KINO_CHECK(again->specification() == chain->specification());
    Image<float> in(11, 7, 2.0f);
    in.at(4, 3) = 0;
    Image<float> out;
    chain->apply(in, out);
    KINO_CHECK_EQ(out.width(), (in.width() + chain->reduction() - 1) / chain->reduction());
}

}  // namespace kino::fuzz
