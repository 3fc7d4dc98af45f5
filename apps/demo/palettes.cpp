#include "apps/demo/palettes.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "viz/scene/scene_file.h"

namespace kino::demo {
namespace {

/// The new colours come with this time constant.
constexpr double kTurnS = 0.12;

using Srgb = std::array<std::uint32_t, kPaletteColors>;

DemoPalette palette_of(const char* name, const Srgb& srgb) {
    DemoPalette palette{.name = name};
    for (std::size_t i = 0; i < kPaletteColors; ++i) {
        palette.linear[i] = to_linear({static_cast<std::uint8_t>(srgb[i] >> 16),
                                       static_cast<std::uint8_t>(srgb[i] >> 8 & 0xff),
                                       static_cast<std::uint8_t>(srgb[i] & 0xff)});
    }
    return palette;
}

}  // namespace

const std::vector<DemoPalette>& demo_palettes() {
    static const std::vector<DemoPalette> all = {
        palette_of("rainbow", {0xff3d2e, 0xff9a1f, 0xffe14d, 0x3ddc84, 0x2fa8ff, 0xb45cff}),
        palette_of("embers", {0xff2a12, 0xff5a1a, 0xff8c1f, 0xffb84a, 0xff3b4e, 0xffd98a}),
        palette_of("deep sea", {0x1a5cff, 0x1f9bff, 0x28d7f0, 0x2ef2c0, 0x3a6bff, 0x9ff5ff}),
        palette_of("northern lights", {0x2bff88, 0x16e0a0, 0x8cff4a, 0x1fd0ff, 0x7a5cff, 0xd46bff}),
        palette_of("candy", {0xff4fa0, 0xff86c8, 0xc86bff, 0x7d8bff, 0x6fe0ff, 0xffd1f0}),
    };
    return all;
}

void Colors::set(std::size_t palette) {
    palette_ = palette % demo_palettes().size();
    now_ = demo_palettes()[palette_].linear;
}

void Colors::step(double dt_s) {
    const auto part = static_cast<float>(1 - std::exp(-dt_s / kTurnS));
    const auto& to = demo_palettes()[palette_ % demo_palettes().size()].linear;
    for (std::size_t i = 0; i < kPaletteColors; ++i) now_[i] = glm::mix(now_[i], to[i], part);
}

std::size_t Colors::index(double rounds) {
    const double at = (rounds - std::floor(rounds)) * static_cast<double>(kPaletteColors);
    return std::min(static_cast<std::size_t>(at), kPaletteColors - 1);
}

glm::vec3 Colors::along(double rounds) const {
    const double at = (rounds - std::floor(rounds)) * static_cast<double>(kPaletteColors);
    const std::size_t i = index(rounds);
    return glm::mix(now_[i], now_[(i + 1) % kPaletteColors],
                    static_cast<float>(at - static_cast<double>(i)));
}

}  // namespace kino::demo
