#include "apps/viewer/depth_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace kino {
namespace {

struct Stop {
    float r, g, b;
};
/// Near to far; lightness falls from 92 to 18 of 100.
constexpr std::array<Stop, 6> kStops = {
    {{255, 232, 150}, {250, 168, 84}, {222, 92, 92}, {146, 58, 128}, {72, 52, 122}, {28, 40, 82}}};
constexpr int kSteps = 1024;

std::array<Rgba8, kSteps> make_table() {
    std::array<Rgba8, kSteps> table;
    for (int i = 0; i < kSteps; ++i) {
        const float at = static_cast<float>(i) / (kSteps - 1) * (kStops.size() - 1);
        const auto low = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
        const float t = at - static_cast<float>(low);
        const auto mix = [&](float a, float b) {
            return static_cast<std::uint8_t>(std::lround(a + (b - a) * t));
        };
        const Stop& a = kStops[low];
        const Stop& b = kStops[low + 1];
        table[static_cast<std::size_t>(i)] = {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), 255};
    }
    return table;
}

/// Source pixel of an out pixel when sizes differ: the one under its centre.
int source_of(int i, int out_size, int size) {
    return std::min(size - 1, (2 * i + 1) * size / (2 * out_size));
}

}  // namespace

std::optional<DepthRange> depth_range(const Image<float>& depth_m) {
    constexpr std::size_t kStride = 37;
    std::vector<float> sample;
    for (std::size_t i = 0; i < depth_m.size(); i += kStride) {
        if (depth_m.data()[i] > 0) sample.push_back(depth_m.data()[i]);
    }
    if (sample.empty()) return std::nullopt;
    std::sort(sample.begin(), sample.end());
    const auto at = [&](double q) {
        return sample[static_cast<std::size_t>(q * static_cast<double>(sample.size() - 1))];
    };
    return DepthRange{at(0.02), std::max(at(0.98), at(0.02) + 0.1f)};
}

Rgba8 depth_color(float depth_m, const DepthRange& range) {
    static const std::array<Rgba8, kSteps> table = make_table();
    if (!(depth_m > 0)) return {0, 0, 0, 255};
    const float t = (depth_m - range.near_m) / (range.far_m - range.near_m);
    return table[static_cast<std::size_t>(std::clamp(t, 0.0f, 1.0f) * (kSteps - 1))];
}

void color_depth(const Image<float>& depth_m, const DepthRange& range, Image<Rgba8>& out) {
    for (int y = 0; y < out.height(); ++y) {
        const float* row = depth_m.row(source_of(y, out.height(), depth_m.height()));
        for (int x = 0; x < out.width(); ++x) {
            out.at(x, y) = depth_color(row[source_of(x, out.width(), depth_m.width())], range);
        }
    }
}

void reduce_picture(const Image<Rgba8>& picture, Image<Rgba8>& out) {
    for (int y = 0; y < out.height(); ++y) {
        const int sy = source_of(y, out.height(), picture.height());
        const int sy2 = std::min(sy + 1, picture.height() - 1);
        for (int x = 0; x < out.width(); ++x) {
            const int sx = source_of(x, out.width(), picture.width());
            const int sx2 = std::min(sx + 1, picture.width() - 1);
            const std::array<Rgba8, 4> four = {picture.at(sx, sy), picture.at(sx2, sy),
                                               picture.at(sx, sy2), picture.at(sx2, sy2)};
            int r = 2, g = 2, b = 2;
            for (const Rgba8& p : four) {
                r += p.r;
                g += p.g;
                b += p.b;
            }
            out.at(x, y) = {static_cast<std::uint8_t>(r / 4), static_cast<std::uint8_t>(g / 4),
                            static_cast<std::uint8_t>(b / 4), 255};
        }
    }
}

void reduce_infrared(const Image<std::uint16_t>& raw, int significant_bits, Image<Rgba8>& out) {
    const int shift = std::max(0, significant_bits - 8);
    for (int y = 0; y < out.height(); ++y) {
        const std::uint16_t* row = raw.row(source_of(y, out.height(), raw.height()));
        for (int x = 0; x < out.width(); ++x) {
            const int value = std::min(row[source_of(x, out.width(), raw.width())] >> shift, 255);
            const auto grey = static_cast<std::uint8_t>(value);
            out.at(x, y) = {grey, grey, grey, 255};
        }
    }
}

}  // namespace kino
