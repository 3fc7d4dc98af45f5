#include "viz/surface/mesh_texels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace kino {
namespace {

/// IEC 61966-2-1.
double srgb_to_linear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double linear_to_srgb(double c) {
    return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

Image<Rgba8> half_size(const Image<Rgba8>& full) {
    static const std::array<double, 256> kLinear = [] {
        std::array<double, 256> table{};
        for (std::size_t i = 0; i < table.size(); ++i) {
            table[i] = srgb_to_linear(static_cast<double>(i) / 255);
        }
        return table;
    }();
    Image<Rgba8> half(std::max(full.width() / 2, 1), std::max(full.height() / 2, 1));
    for (int y = 0; y < half.height(); ++y) {
        for (int x = 0; x < half.width(); ++x) {
            std::array<double, 4> sum{};
            for (int k = 0; k < 4; ++k) {
                const Rgba8 texel = full.at(std::min(2 * x + k % 2, full.width() - 1),
                                            std::min(2 * y + k / 2, full.height() - 1));
                sum[0] += kLinear[texel.r];
                sum[1] += kLinear[texel.g];
                sum[2] += kLinear[texel.b];
                sum[3] += texel.a;
            }
            const auto coded = [](double v) {
                return static_cast<std::uint8_t>(std::lround(255 * linear_to_srgb(v / 4)));
            };
            half.at(x, y) = {coded(sum[0]), coded(sum[1]), coded(sum[2]),
                             static_cast<std::uint8_t>(std::lround(sum[3] / 4))};
        }
    }
    return half;
}

}  // namespace

std::vector<std::uint32_t> pack_textures(
    std::span<const std::shared_ptr<const Image<Rgba8>>> textures) {
    std::vector<std::uint32_t> words(textures.size() * kTextureHeadWords);
    for (std::size_t t = 0; t < textures.size(); ++t) {
        Image<Rgba8> level = *textures[t];
        const std::size_t head = t * kTextureHeadWords;
        words[head] = static_cast<std::uint32_t>(level.width());
        words[head + 1] = static_cast<std::uint32_t>(level.height());
        for (std::size_t l = 0; l < kMostTextureLevels; ++l) {
            words[head + 2] = static_cast<std::uint32_t>(l + 1);
            words[head + 4 + l] = static_cast<std::uint32_t>(words.size());
            for (const Rgba8 texel : level.pixels()) {
                words.push_back(std::bit_cast<std::uint32_t>(texel));
            }
            if (level.width() == 1 && level.height() == 1) break;
            level = half_size(level);
        }
    }
    return words;
}

}  // namespace kino
