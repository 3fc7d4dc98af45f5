#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "sensor/filters/depth_filter.h"
#include "tests/support/random.h"

namespace kino::test {

/// Depth as a Kinect sees it: tilted planes with steps between them, sigma of 0.0017 1/m in inverse
/// depth, and a share of holes one to twelve pixels wide.
inline Image<float> noisy_room(int width, int height, std::uint64_t seed, double noise = 0.0017,
                               double holes = 0.01) {
    Random random(seed);
    Image<float> out(width, height);
    const double tilt_x = random.real(-0.001, 0.001);
    const double tilt_y = random.real(-0.001, 0.001);
    const int edge_x = random.integer(0, width);
    const int edge_y = random.integer(0, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double inverse = x < edge_x ? 0.4 : y < edge_y ? 0.9 : 0.55;
            inverse += tilt_x * x + tilt_y * y;
            // Three uniform numbers are normal enough, and bounded.
            for (int i = 0; i < 3; ++i) inverse += noise * random.real(-1, 1);
            out.at(x, y) = static_cast<float>(1 / std::max(inverse, 0.1));
        }
    }
    for (int i = 0; i < holes * width * height; ++i) {
        const int x = random.integer(0, width - 1);
        const int y = random.integer(0, height - 1);
        const int length = random.integer(1, 12);
        const bool along = random.chance(0.5);
        for (int k = 0; k < length; ++k) {
            const int u = along ? x + k : x;
            const int v = along ? y : y + k;
            if (out.contains(u, v)) out.at(u, v) = 0;
        }
    }
    return out;
}

/// The same with everything a depth picture must never hold strewn in.
inline Image<float> hostile_room(int width, int height, std::uint64_t seed) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float values[] = {std::numeric_limits<float>::quiet_NaN(),
                            -std::numeric_limits<float>::quiet_NaN(),
                            kInfinity,
                            -kInfinity,
                            -1.5f,
                            -0.0f,
                            std::numeric_limits<float>::denorm_min(),
                            std::numeric_limits<float>::max(),
                            std::numeric_limits<float>::lowest(),
                            kNearestReadingM,
                            std::nextafter(kNearestReadingM, 0.0f),
                            kFarthestReadingM,
                            std::nextafter(kFarthestReadingM, kInfinity)};
    Image<float> out = noisy_room(width, height, seed);
    Random random(seed ^ 0x5EED);
    for (float& z : out.pixels()) {
        if (random.chance(0.15)) z = values[random.integer(0, std::size(values) - 1)];
    }
    return out;
}

struct Size {
    int width, height;
};
/// Whole and broken multiples of 8 and 64, single rows, columns and pixels, and nothing.
inline const std::vector<Size> kSizes = {{160, 120}, {67, 41}, {64, 3}, {129, 9}, {1, 1},
                                         {1, 40},    {40, 1},  {2, 2},  {7, 7},   {0, 0}};

inline Image<float> filtered(DepthFilter& filter, const Image<float>& in) {
    Image<float> out;
    filter.apply(in, out);
    return out;
}

/// Creates the filter or ends the test.
template <class Filter, class Parameters>
std::unique_ptr<Filter> make_filter(const Parameters& parameters, bool simd = true) {
    auto filter = Filter::create(parameters, {.simd = simd});
    KINO_CHECK(filter.has_value());
    return std::move(*filter);
}

inline bool same_bits(const Image<float>& a, const Image<float>& b) {
    return a.width() == b.width() && a.height() == b.height() &&
           (a.size() == 0 || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

}  // namespace kino::test
