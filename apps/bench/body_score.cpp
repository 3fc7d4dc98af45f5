#include "apps/bench/body_score.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {

void BodyScore::add(const BodyFrame& truth, const BodyFrame& found) {
    for (const Body& body : truth.bodies) {
        const Body* nearest = nullptr;
        float least = 1.0f;
        for (const Body& candidate : found.bodies) {
            const float distance = glm::distance(candidate[Joint::hip_center].position_m,
                                                 body[Joint::hip_center].position_m);
            if (distance >= least) continue;
            least = distance;
            nearest = &candidate;
        }
        const auto seen = std::count_if(body.joints.begin(), body.joints.end(), [](const auto& j) {
            return j.state == JointState::tracked;
        });
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& at = body.joints[j];
            JointError error{kLostMm, at.position_m.z, static_cast<std::uint8_t>(j),
                             at.state == JointState::tracked, static_cast<std::uint8_t>(seen)};
            if (nearest != nullptr && nearest->joints[j].state != JointState::lost)
                error.mm = 1000 * glm::distance(nearest->joints[j].position_m, at.position_m);
            errors_.push_back(error);
        }
    }
}

void BodyScore::add(const BodyScore& other) {
    errors_.insert(errors_.end(), other.errors_.begin(), other.errors_.end());
}

ErrorFigures BodyScore::figures(const std::function<bool(const JointError&)>& wanted) const {
    ErrorFigures out;
    for (const JointError& e : errors_) {
        if (wanted && !wanted(e)) continue;
        ++out.n;
        out.mean_mm += static_cast<double>(e.mm);
        out.within_100 += e.mm <= 100 ? 1 : 0;
        out.within_150 += e.mm <= 150 ? 1 : 0;
        out.lost += e.mm == kLostMm ? 1 : 0;
    }
    const double n = std::max<double>(1, static_cast<double>(out.n));
    out.mean_mm /= n;
    out.within_100 /= n;
    out.within_150 /= n;
    out.lost /= n;
    return out;
}

ShareInterval wilson(std::size_t hits, std::size_t n) {
    if (n == 0) return {0, 0, 1};
    constexpr double z = 1.959964;
    const auto count = static_cast<double>(n);
    const double p = static_cast<double>(hits) / count;
    const double middle = (p + z * z / (2 * count)) / (1 + z * z / count);
    const double half =
        z / (1 + z * z / count) * std::sqrt(p * (1 - p) / count + z * z / (4 * count * count));
    return {p, middle - half, middle + half};
}

}  // namespace kino
