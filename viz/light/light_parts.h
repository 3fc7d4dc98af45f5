#pragma once

#include <cstdint>
#include <vector>

#include "viz/scene/scene.h"

namespace kino {

/// Parts of a picture's light that may be shaded at rates of their own, as bits of a set. What a
/// light is declared as says which part its light belongs to.
constexpr std::uint32_t kShadowedLights = 1;  ///< cast shadows by rays: sharp and dear
constexpr std::uint32_t kPlainLights = 2;     ///< all others of the scene
constexpr std::uint32_t kBouncedLights = 4;   ///< what bouncing lights shine on: smooth and many
constexpr std::uint32_t kAllLights = 7;

/// The part that the light's direct light belongs to.
[[nodiscard]] std::uint32_t part_of(const Light& light);
/// Parts that the scene has lights of. Bounced ones only if there is anything to light.
[[nodiscard]] std::uint32_t light_parts(const Scene& scene);

/// Resizing factors of the parts, each at least 1; 0: that of the framebuffer LOD.
struct PartRates {
    double shadowed = 0;
    double plain = 0;
    double bounced = 0;
    friend bool operator==(const PartRates&, const PartRates&) = default;
};

/// Parts that are shaded together on one surface.
struct LightLevel {
    double r = 1;
    std::uint32_t parts = kAllLights;
    friend bool operator==(const LightLevel&, const LightLevel&) = default;
};

/// Where the parts in `present` are shaded: levels from fine to coarse, whose factors are r0 2^m
/// beside 1, so that each level's surface can be picked from that of the level before. r0 is the
/// least factor above 1 that a present part asks for, and the others go to the nearest level by
/// logarithm. `lod_r`: the framebuffer LOD's factor, 1 without. One level where nothing asks for
/// more.
[[nodiscard]] std::vector<LightLevel> light_levels(const PartRates& rates, std::uint32_t present,
                                                   double lod_r);

}  // namespace kino
