#include "apps/stage/swarm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/stage/chance.h"

namespace kino {
namespace {

constexpr double kRound = 2 * std::numbers::pi;
/// Of half the box: how far a drifting light goes to either side of its seat.
constexpr double kReach = 0.3;
/// Part of the way up in which a rising light comes, and goes.
constexpr double kEnds = 0.15;

double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

}  // namespace

Swarm::Swarm(const SceneSwarm& file) : file_(file) {
    Chance chance(static_cast<std::uint64_t>(file.seed));
    all_.resize(static_cast<std::size_t>(file.count));
    const auto three = [&](double from, double to) {
        const double x = chance.between(from, to);
        const double y = chance.between(from, to);
        return glm::dvec3(x, y, chance.between(from, to));
    };
    for (std::size_t i = 0; i < all_.size(); ++i) {
        One& one = all_[i];
        one.seat = three(-1, 1);
        one.phase = three(0, kRound);
        one.pace = three(0.6, 1.4);
        one.color = file.palette.empty() ? 0 : i % file.palette.size();
        one.intensity = chance.between(file.intensity.x, file.intensity.y);
        one.radius_m = chance.between(file.radius_m.x, file.radius_m.y);
    }
}

SwarmMoment Swarm::at(std::size_t i, double time_s) const {
    const One& one = all_[i];
    const glm::dvec3 half = 0.5 * file_.size_m;
    glm::dvec3 seat = one.seat;
    SwarmMoment moment;
    const auto sway = [&](int axis) {
        const double reach = kReach * half[axis];
        if (reach <= 0) return 0.0;
        const double turns = file_.speed_m_s * one.pace[axis] / reach;
        return std::sin(turns * time_s + one.phase[axis]);
    };
    switch (file_.movement) {
        case SceneMovement::still:
            break;
        case SceneMovement::drift:
            for (int k = 0; k < 3; ++k) seat[k] = (1 - kReach) * one.seat[k] + kReach * sway(k);
            break;
        case SceneMovement::orbit: {
            // Evenly over the ellipse that fits the box.
            const double out = std::sqrt(0.5 * (one.seat.x + 1));
            const double radius = std::max(0.1, out * std::max(half.x, half.z));
            const double angle = one.phase.x + file_.speed_m_s * one.pace.x / radius * time_s;
            seat = {out * std::cos(angle), (1 - kReach) * one.seat.y + kReach * sway(1),
                    out * std::sin(angle)};
            break;
        }
        case SceneMovement::rise: {
            const double height = std::max(file_.size_m.y, 0.01);
            const double way =
                0.5 * (one.seat.y + 1) + file_.speed_m_s * one.pace.y / height * time_s;
            const double up = way - std::floor(way);
            moment.weight = smooth(up / kEnds) * smooth((1 - up) / kEnds);
            seat = {(1 - kReach) * one.seat.x + kReach * sway(0), 2 * up - 1,
                    (1 - kReach) * one.seat.z + kReach * sway(2)};
            break;
        }
    }
    moment.stage_m = file_.center_m + half * seat;
    return moment;
}

}  // namespace kino
