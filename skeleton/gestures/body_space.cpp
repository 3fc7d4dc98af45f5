#include "skeleton/gestures/body_space.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kino {
namespace {

using glm::dvec3;

constexpr double kAxesTimeS = 0.08, kArmTimeS = 1.0;
constexpr double kLeastArmM = 0.25, kMostArmM = 1.1;
constexpr double kStartArmOfTrunk = 1.2;  // until an arm has been seen

bool seen(const JointPosition& joint) {
    const glm::vec3& p = joint.position_m;
    return joint.state != JointState::lost && std::abs(p.x) < 100 && std::abs(p.y) < 100 &&
           std::abs(p.z) < 100;
}

constexpr std::array<std::array<Joint, 4>, 2> kArm = {
    {{Joint::shoulder_left, Joint::elbow_left, Joint::wrist_left, Joint::hand_left},
     {Joint::shoulder_right, Joint::elbow_right, Joint::wrist_right, Joint::hand_right}}};

}  // namespace

void BodySpace::learn_arm(const Body& body, double dt_s) {
    for (const auto& arm : kArm) {
        double length_m = 0;
        bool whole = true;
        for (std::size_t i = 0; i < arm.size() && whole; ++i) {
            whole = seen(body[arm[i]]) && body[arm[i]].state == JointState::tracked;
            if (whole && i > 0)
                length_m += glm::distance(dvec3(body[arm[i - 1]].position_m),
                                          dvec3(body[arm[i]].position_m));
        }
        if (!whole) continue;
        length_m = std::clamp(length_m, kLeastArmM, kMostArmM);
        const double w = -std::expm1(-dt_s / kArmTimeS);
        arm_m_ += w * (length_m - arm_m_);
    }
}

std::optional<BodyView> BodySpace::view(const Body& body, double time_s) {
    for (const Joint j :
         {Joint::shoulder_left, Joint::shoulder_right, Joint::shoulder_center, Joint::hip_center})
        if (!seen(body[j])) return std::nullopt;
    const dvec3 left_m(body[Joint::shoulder_left].position_m);
    const dvec3 right_m(body[Joint::shoulder_right].position_m);
    const dvec3 origin = (left_m + right_m) * 0.5;
    const dvec3 trunk =
        dvec3(body[Joint::shoulder_center].position_m) - dvec3(body[Joint::hip_center].position_m);
    const double trunk_m = glm::length(trunk);
    if (trunk_m < 0.1) return std::nullopt;
    const dvec3 up = trunk / trunk_m;
    dvec3 left = left_m - right_m;
    left -= up * glm::dot(left, up);
    if (glm::length(left) < 0.05) return std::nullopt;
    left = glm::normalize(left);
    const glm::dmat3 now(left, up, glm::cross(left, up));

    const double dt_s = time_s - time_s_;
    if (!started_) {
        started_ = true;
        axes_ = now;
        arm_m_ = std::clamp(kStartArmOfTrunk * trunk_m, kLeastArmM, kMostArmM);
        learn_arm(body, 10 * kArmTimeS);
    } else {
        const double w = -std::expm1(-dt_s / kAxesTimeS);
        const dvec3 y = axes_[1] + w * (up - axes_[1]);
        dvec3 x = axes_[0] + w * (left - axes_[0]);
        x -= y * (glm::dot(x, y) / std::max(glm::dot(y, y), 1e-9));
        // Opposite axes have no mean: a person who seems to have turned round at once.
        axes_ = glm::length(x) > 0.1 && glm::length(y) > 0.1
                    ? glm::dmat3(glm::normalize(x), glm::normalize(y),
                                 glm::cross(glm::normalize(x), glm::normalize(y)))
                    : now;
        learn_arm(body, dt_s);
    }
    time_s_ = time_s;

    const auto local = [&](Joint j) {
        return glm::transpose(axes_) * (dvec3(body[j].position_m) - origin) / arm_m_;
    };
    BodyView out;
    out.time_s = time_s;
    out.arm_m = arm_m_;
    out.trunk_m = origin;
    const double far_m = glm::length(origin);
    if (far_m > 1e-6)
        out.turn_rad = std::acos(std::clamp(glm::dot(axes_[2], -origin / far_m), -1.0, 1.0));
    out.head_seen = seen(body[Joint::head]);
    if (out.head_seen) out.head = local(Joint::head);
    for (std::size_t side = 0; side < 2; ++side) {
        out.shoulder[side] = local(kArm[side][0]);
        const JointPosition &elbow = body[kArm[side][1]], &hand = body[kArm[side][3]];
        out.arm_seen[side] = seen(elbow) && seen(hand);
        if (!out.arm_seen[side]) continue;
        out.elbow[side] = local(kArm[side][1]);
        out.hand[side] = local(kArm[side][3]);
        const float least = std::min(elbow.confidence, hand.confidence);
        out.confidence[side] = least >= 0 ? std::min(least, 1.f) : 0;
    }
    return out;
}

}  // namespace kino
