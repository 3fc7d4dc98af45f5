#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace kino::demo {

inline double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

/// Evenly towards `target`, 0 to 1 in `whole_s`.
inline void approach(double& value, double target, double dt_s, double whole_s) {
    const double most = whole_s > 0 ? dt_s / whole_s : 1;
    value += std::clamp(target - value, -most, most);
}

/// The part of the way to a target that is gone in this time, with this time constant.
inline double eased(double dt_s, double constant_s) {
    return 1 - std::exp(-dt_s / constant_s);
}

inline bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace kino::demo
