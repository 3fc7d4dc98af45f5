#include "viz/light/light_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/check.h"
#include "viz/light/indirect.h"
#include "viz/light/light_records.h"

namespace kino {

std::uint32_t part_of(const Light& light) {
    return light.shadow == LightShadow::raycast ? kShadowedLights : kPlainLights;
}

std::uint32_t light_parts(const Scene& scene) {
    std::uint32_t parts = bouncing_lights(scene).empty() ? 0 : kBouncedLights;
    for (const Light& light : scene.lights) {
        if (is_usable(light)) parts |= part_of(light);
    }
    return parts;
}

std::vector<LightLevel> light_levels(const PartRates& rates, std::uint32_t present, double lod_r) {
    struct Asked {
        double r;
        std::uint32_t part;
    };
    std::array<Asked, 3> asked = {{{rates.shadowed, kShadowedLights},
                                   {rates.plain, kPlainLights},
                                   {rates.bounced, kBouncedLights}}};
    double first = HUGE_VAL;  // of those that are resized
    std::uint32_t whole = 0;
    for (Asked& a : asked) {
        KINO_CHECK(a.r == 0 || a.r >= 1);
        if (a.r == 0) a.r = lod_r;
        if ((present & a.part) == 0) continue;
        if (a.r == 1) {
            whole |= a.part;
        } else {
            first = std::min(first, a.r);
        }
    }
    if (present == 0) return {{.r = lod_r, .parts = kAllLights}};
    std::map<double, std::uint32_t> parts_of_r;
    if (whole != 0) parts_of_r[1] = whole;
    for (const Asked& a : asked) {
        if ((present & a.part & ~whole) == 0) continue;
        parts_of_r[first * std::exp2(std::round(std::log2(a.r / first)))] |= a.part;
    }
    // What the scene has none of goes along anywhere.
    parts_of_r.begin()->second |= kAllLights & ~present;
    std::vector<LightLevel> levels;
    for (const auto& [r, parts] : parts_of_r) levels.push_back({.r = r, .parts = parts});
    return levels;
}

}  // namespace kino
