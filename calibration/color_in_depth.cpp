#include "calibration/color_in_depth.h"

#include <algorithm>

namespace kino {
namespace {

constexpr int kOne = 1 << kUvFractionBits;

// The two channels in the odd or even bytes at once: 8-bit values times weights up to 256 fit the
// 16 bits between them, and the sum of the four weights is exactly 256.
std::uint32_t blend(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                    const std::uint32_t (&weight)[4]) {
    constexpr std::uint32_t kEven = 0x00FF00FFu;
    constexpr std::uint32_t kHalf = 0x00800080u;
    const auto mix = [&](int shift) {
        return ((a >> shift & kEven) * weight[0] + (b >> shift & kEven) * weight[1] +
                (c >> shift & kEven) * weight[2] + (d >> shift & kEven) * weight[3] + kHalf) >>
                   8 &
               kEven;
    };
    return mix(0) | mix(8) << 8;
}

std::uint32_t bits(Rgba8 c) {
    return static_cast<std::uint32_t>(c.r) | static_cast<std::uint32_t>(c.g) << 8 |
           static_cast<std::uint32_t>(c.b) << 16 | static_cast<std::uint32_t>(c.a) << 24;
}

Rgba8 opaque(std::uint32_t v) {
    return {static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8),
            static_cast<std::uint8_t>(v >> 16), 255};
}

Rgba8 sample_nearest(const Image<Rgba8>& color, ColorUv p) {
    const int x = (p.u + kOne / 2) >> kUvFractionBits;
    const int y = (p.v + kOne / 2) >> kUvFractionBits;
    if (!color.contains(x, y)) return {0, 0, 0, 0};
    return opaque(bits(color.at(x, y)));
}

Rgba8 sample_bilinear(const Image<Rgba8>& color, ColorUv p) {
    const int x = p.u >> kUvFractionBits;
    const int y = p.v >> kUvFractionBits;
    if (!color.contains(x, y)) return {0, 0, 0, 0};
    const Rgba8* top = color.row(y);
    const Rgba8* bottom = color.row(std::min(y + 1, color.height() - 1));
    const int right = std::min(x + 1, color.width() - 1);
    const auto fu = static_cast<std::uint32_t>(p.u % kOne);
    const auto fv = static_cast<std::uint32_t>(p.v % kOne);
    const std::uint32_t weight[4] = {(kOne - fu) * (kOne - fv), fu * (kOne - fv), (kOne - fu) * fv,
                                     fu * fv};
    return opaque(
        blend(bits(top[x]), bits(top[right]), bits(bottom[x]), bits(bottom[right]), weight));
}

template <class Sample>
void resample(const Image<ColorUv>& uv, const Image<Rgba8>& color, Image<Rgba8>& out,
              Sample sample) {
    const std::span<const ColorUv> from = uv.pixels();
    const std::span<Rgba8> to = out.pixels();
    for (std::size_t i = 0; i < from.size(); ++i) {
        to[i] = from[i].valid() ? sample(color, from[i]) : Rgba8{0, 0, 0, 0};
    }
}

}  // namespace

void register_color(const Image<ColorUv>& uv, const Image<Rgba8>& color, ColorSampling sampling,
                    Image<Rgba8>& out) {
    out.resize(uv.width(), uv.height());
    if (sampling == ColorSampling::nearest) {
        resample(uv, color, out, sample_nearest);
    } else {
        resample(uv, color, out, sample_bilinear);
    }
}

}  // namespace kino
