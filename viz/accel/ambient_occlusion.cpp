#include "viz/accel/ambient_occlusion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/check.h"
#include "viz/accel/traverse.h"

namespace kino {
namespace {

double fraction(double x) {
    return x - std::floor(x);
}

/// Integer hash by Wellons ("lowbias32").
std::uint32_t mixed(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

}  // namespace

double ambient_openness(const Bvh& bvh, const SurfacePlace& at, float reach_m, int rays,
                        std::uint32_t seed) {
    KINO_CHECK(rays > 0);
    const glm::vec3 other = std::abs(at.normal.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 u = glm::normalize(glm::cross(at.normal, other));
    const glm::vec3 v = glm::cross(at.normal, u);
    const glm::vec3 origin = at.place + at.normal * (4 * hit_error_m(at.place, 0));
    const double turn_a = mixed(2 * seed) / 4294967296.0;
    const double turn_b = mixed(2 * seed + 1) / 4294967296.0;
    constexpr double kPlastic = 1.32471795724474602596;
    int open = 0;
    for (int i = 0; i < rays; ++i) {
        const double a = fraction(turn_a + (i + 0.5) / kPlastic);
        const double b = fraction(turn_b + (i + 0.5) / (kPlastic * kPlastic));
        // Even on the disc below the hemisphere is cosine-weighted on it (Malley's method).
        const double radius = std::sqrt(a);
        const double angle = 2 * std::numbers::pi * b;
        const glm::vec3 direction = static_cast<float>(radius * std::cos(angle)) * u +
                                    static_cast<float>(radius * std::sin(angle)) * v +
                                    static_cast<float>(std::sqrt(std::max(1 - a, 0.0))) * at.normal;
        open += !any_hit(bvh, {.origin = origin, .direction = direction, .t_max = reach_m});
    }
    return open / static_cast<double>(rays);
}

}  // namespace kino
