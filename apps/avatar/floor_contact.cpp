#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "apps/avatar/retarget.h"
#include "apps/avatar/turns.h"

namespace kino {
namespace {

Joint leg_joint(Joint left, int side) {
    return static_cast<Joint>(static_cast<int>(left) + 4 * side);
}

}  // namespace

double Retarget::sole_y_m(int side) const {
    const Joint ankle = leg_joint(Joint::ankle_left, side);
    const glm::dquat& foot = turn_[index_of(leg_joint(Joint::foot_left, side))];
    const glm::dvec3& at_rest = rest_->joint_m[index_of(ankle)];
    const auto s = static_cast<std::size_t>(side);
    const double heel = (foot * (rest_->heel_m[s] - at_rest)).y;
    const double toe = (foot * (rest_->toe_m[s] - at_rest)).y;
    return joint_m_[index_of(ankle)].y + scale_ * std::min(heel, toe);
}

/// Soles of feet that the person has on the floor come onto it: first the whole body is lifted or
/// let down, which leaves knees as bent as they are, then each leg bends for what is left. No sole
/// is below the floor.
void Retarget::stand_on(const BodyAim& aim, double floor_y_m, double dt_s, bool at_once) {
    std::array<double, 2> contact{};
    double lift = 0;
    double sum = 0;
    for (int side = 0; side < 2; ++side) {
        const std::size_t ankle = index_of(leg_joint(Joint::ankle_left, side));
        const std::size_t foot = index_of(leg_joint(Joint::foot_left, side));
        // Heights of both joints over the sole of a person of average size.
        double height = 1e9;
        if (aim.seen[ankle]) height = aim.joint_m[ankle].y - 0.085 - floor_y_m;
        if (aim.seen[foot]) height = std::min(height, aim.joint_m[foot].y - 0.035 - floor_y_m);
        double& c = contact[static_cast<std::size_t>(side)];
        c = 1 - ease_between(0.05, 0.12, height);
        if (c <= 0) continue;
        // A foot that stands is level, unless the person clearly stands on toes.
        glm::dquat& turn = turn_[foot];
        const glm::dvec3 up = turn * glm::dvec3(0, 1, 0);
        const double level =
            c * (1 - ease_between(0.35, 0.7, std::acos(std::clamp(up.y, -1.0, 1.0))));
        turn = mix_turns(turn, shortest_arc(up, {0, 1, 0}, {1, 0, 0}) * turn, level);
        place(leg_joint(Joint::foot_left, side), turn);
        lift += c * (floor_y_m - sole_y_m(side));
        sum += c;
    }
    if (sum > 0) {
        // In the air the body keeps the lift it had.
        const double share = at_once ? 1.0 : (1 - std::exp(-dt_s / 0.05)) * std::min(sum, 1.0);
        lift_m_ = glm::mix(lift_m_, std::clamp(lift / sum, -0.6, 0.6), share);
    }
    const auto raise_all = [&](double metres) {
        for (glm::dvec3& joint : joint_m_) joint.y += metres;
    };
    raise_all(lift_m_);
    // Legs that do not reach let the body down further.
    double drop = 0;
    std::array<glm::dvec3, 2> wanted;
    for (int side = 0; side < 2; ++side) {
        const auto s = static_cast<std::size_t>(side);
        const glm::dvec3 ankle = joint_m_[index_of(leg_joint(Joint::ankle_left, side))];
        const glm::dvec3 hip = joint_m_[index_of(leg_joint(Joint::hip_left, side))];
        const double missing = floor_y_m - sole_y_m(side);
        wanted[s] = ankle + glm::dvec3(0, missing > 0 ? missing : contact[s] * missing, 0);
        const std::size_t knee = index_of(leg_joint(Joint::knee_left, side));
        const std::size_t end = index_of(leg_joint(Joint::ankle_left, side));
        const double leg =
            0.9995 * scale_ *
            (rest_->length_m[knee] * ratio_[knee] + rest_->length_m[end] * ratio_[end]);
        const double out2 = (wanted[s].x - hip.x) * (wanted[s].x - hip.x) +
                            (wanted[s].z - hip.z) * (wanted[s].z - hip.z);
        const double down = std::sqrt(std::max(leg * leg - out2, 0.0));
        if (contact[s] > 0) {
            drop = std::max(drop, contact[s] * (hip.y - wanted[s].y - down));
        }
    }
    drop = std::clamp(drop, 0.0, 0.6);
    raise_all(-drop);
    for (int side = 0; side < 2; ++side) {
        // Feet in the air go down with the body, as far as the floor allows.
        const auto s = static_cast<std::size_t>(side);
        const double free = (1 - contact[s]) * drop;
        wanted[s].y -= std::clamp(sole_y_m(side) + drop - floor_y_m, 0.0, free);
        bend_leg(side, wanted[s]);
    }
}

/// Two bones by the law of cosines, the knee staying on the side where it is.
void Retarget::bend_leg(int side, const glm::dvec3& ankle_m) {
    const Joint knee = leg_joint(Joint::knee_left, side);
    const Joint ankle = leg_joint(Joint::ankle_left, side);
    const Joint foot = leg_joint(Joint::foot_left, side);
    const glm::dvec3 hip = joint_m_[index_of(leg_joint(Joint::hip_left, side))];
    const glm::dvec3 before_ankle = joint_m_[index_of(ankle)];
    if (glm::length(ankle_m - before_ankle) < 1e-9) return;
    const glm::dvec3 before = joint_m_[index_of(knee)];
    const double a = glm::length(before - hip);
    const double b = glm::length(before_ankle - before);
    const glm::dvec3 line = ankle_m - hip;
    const glm::dvec3 along = unit_or(line, turn_[0] * glm::dvec3(0, -1, 0));
    const double far = std::clamp(glm::length(line), std::abs(a - b) + 1e-4, a + b - 1e-6);
    const glm::dvec3 forward = turn_[index_of(knee)] * glm::dvec3(0, 0, 1);
    const glm::dvec3 bent = before - hip - along * glm::dot(along, before - hip);
    // A leg that was straight bends forwards.
    const glm::dvec3 side_of_knee =
        across(along, bent + forward * (glm::length(bent) < 0.01 ? 0.02 : 0.0));
    const double down = (far * far + a * a - b * b) / (2 * far);
    const double out = std::sqrt(std::max(a * a - down * down, 0.0));
    const glm::dvec3 at = hip + along * down + side_of_knee * out;
    const glm::dvec3 end = hip + along * far;
    const auto turn_bone = [&](Joint segment, const glm::dvec3& from, const glm::dvec3& to) {
        glm::dquat& turn = turn_[index_of(segment)];
        turn = shortest_arc(unit_or(from, {0, -1, 0}), unit_or(to, {0, -1, 0}), {1, 0, 0}) * turn;
        turn *= 1 / glm::length(turn);
    };
    turn_bone(knee, before - hip, at - hip);
    turn_bone(ankle, before_ankle - before, end - at);
    joint_m_[index_of(knee)] = at;
    joint_m_[index_of(ankle)] = end;
    place(foot, turn_[index_of(foot)]);
}

}  // namespace kino
