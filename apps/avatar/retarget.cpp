#include "apps/avatar/retarget.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <tuple>

#include "apps/avatar/turns.h"
#include "skeleton/synthetic/body_model.h"

namespace kino {
namespace {

constexpr double kDegree = 0.017453292519943295;
constexpr glm::dquat kNoTurn{1, 0, 0, 0};

Joint sided(Joint left, int side) {
    return static_cast<Joint>(static_cast<int>(left) + 4 * side);
}

/// Bones whose lengths are measured; those of hands, feet and head are the tracker's guess.
bool is_measured_bone(Joint joint) {
    switch (joint) {
        case Joint::hip_center:
        case Joint::head:
        case Joint::hand_left:
        case Joint::hand_right:
        case Joint::foot_left:
        case Joint::foot_right:
            return false;
        default:
            return true;
    }
}

glm::dquat about(const glm::dvec3& axis, double angle_rad) {
    return glm::angleAxis(angle_rad, axis);
}

/// The turn about `axis` by the multiple of a full circle nearest to `before`, within `limit`.
double unwound(double angle, double before, double limit) {
    const double circle = 6.283185307179586;
    angle += circle * std::round((before - angle) / circle);
    return std::clamp(angle, -limit, limit);
}

}  // namespace

Retarget::Retarget(std::shared_ptr<const RestBody> rest, const RetargetLimits& limits)
    : rest_(std::move(rest)), limits_(limits) {
    ratio_.fill(1);
    turn_.fill(kNoTurn);
    ease_.fill(kNoTurn);
    remember_ease();
}

void Retarget::remember_ease() {
    const PosedBody body = pose_body(standing_pose());
    BodyAim aim;
    aim.joint_m = body.joint_m;
    aim.seen.fill(true);
    root_m_ = body[Joint::hip_center];
    solve(aim, 0, true);
    for (std::size_t j = 0; j < kJointCount; ++j) ease_[j] = segment_[j].local;
    segment_ = {};
    // A body that is seen in part only stands at ease with the rest of it.
    for (std::size_t j = 0; j < kJointCount; ++j) segment_[j].local = ease_[j];
}

std::optional<glm::dvec3> Retarget::bone(const BodyAim& aim, Joint from, Joint to) const {
    if (!aim.seen[index_of(from)] || !aim.seen[index_of(to)]) return std::nullopt;
    const glm::dvec3 way = aim.joint_m[index_of(to)] - aim.joint_m[index_of(from)];
    // Joints in one place say nothing of the bone between them.
    if (!(glm::dot(way, way) > 1e-6)) return std::nullopt;
    return glm::normalize(way);
}

void Retarget::settle(Joint segment, const glm::dquat& parent,
                      const std::optional<glm::dquat>& wanted, double dt_s, bool at_once,
                      double twist_rad) {
    Segment& s = segment_[index_of(segment)];
    if (wanted) {
        if (s.lost_s > 0) s.back_s = 0;
        s.lost_s = 0;
        const double ramp = std::clamp(s.back_s / limits_.return_s, 0.0, 1.0);
        const double rate = glm::mix(limits_.returning_turn_rate, limits_.turn_rate, ramp);
        s.back_s += dt_s;
        s.local = at_once ? *wanted : turn_towards(s.local, *wanted, rate * dt_s);
        const double most = at_once ? 1e9 : rate * dt_s;
        s.twist_rad += std::clamp(twist_rad - s.twist_rad, -most, most);
    } else {
        s.lost_s += dt_s > 0 ? dt_s : 1e-9;
        if (s.lost_s > limits_.hold_s) {
            s.local = turn_towards(s.local, ease_[index_of(segment)], limits_.ease_rate * dt_s);
            const double most = limits_.ease_rate * dt_s;
            s.twist_rad += std::clamp(-s.twist_rad, -most, most);
        }
    }
    turn_[index_of(segment)] = parent * s.local;
    turn_[index_of(segment)] *= 1 / glm::length(turn_[index_of(segment)]);
}

glm::dquat Retarget::swing(Joint segment, const glm::dvec3& way) const {
    const glm::dvec3& axis = rest_->axis[index_of(segment)];
    const glm::dvec3& hinge = rest_->hinge[index_of(segment)];
    const glm::dquat arc = shortest_arc(axis, way, hinge);
    // Near the opposite of the rest direction the arc's axis is noise: what was before is carried
    // on instead. Both take the bone to `way`.
    const double carried = ease_between(-0.77, -0.94, glm::dot(axis, way));
    if (carried <= 0) return arc;
    const glm::dquat& before = segment_[index_of(segment)].local;
    const glm::dquat free = before * about(axis, -segment_[index_of(segment)].twist_rad);
    return mix_turns(arc, shortest_arc(free * axis, way, hinge) * free, carried);
}

void Retarget::place(Joint joint, const glm::dquat& turn) {
    const std::size_t j = index_of(joint);
    joint_m_[j] = joint_m_[index_of(kJointParent[j])] +
                  turn * rest_->axis[j] * (rest_->length_m[j] * ratio_[j] * scale_);
}

std::optional<glm::dvec3> Retarget::root_of(const BodyAim& aim) const {
    if (aim.seen[index_of(Joint::hip_center)]) return aim.joint_m[index_of(Joint::hip_center)];
    const bool left = aim.seen[index_of(Joint::hip_left)];
    const bool right = aim.seen[index_of(Joint::hip_right)];
    const glm::dvec3 l = aim.joint_m[index_of(Joint::hip_left)];
    const glm::dvec3 r = aim.joint_m[index_of(Joint::hip_right)];
    if (left && right) return 0.5 * (l + r);
    const double trunk =
        scale_ * (rest_->length_m[index_of(Joint::spine)] * ratio_[index_of(Joint::spine)] +
                  rest_->length_m[index_of(Joint::shoulder_center)] *
                      ratio_[index_of(Joint::shoulder_center)]);
    const glm::dvec3 up = placed_ ? turn_[0] * rest_->axis[0] : glm::dvec3(0, 1, 0);
    if (aim.seen[index_of(Joint::shoulder_center)]) {
        return aim.joint_m[index_of(Joint::shoulder_center)] - up * trunk;
    }
    return std::nullopt;
}

void Retarget::estimate_lengths(const BodyAim& aim, const RetargetOptions& options, double dt_s) {
    if (!options.scale_bones) {
        scale_ = 1;
        ratio_.fill(1);
        measured_.fill(false);
        scaled_ = false;
        return;
    }
    PerJoint<double> length{};
    double seen = 0;
    double at_rest = 0;
    for (std::size_t j = 1; j < kJointCount; ++j) {
        const auto joint = static_cast<Joint>(j);
        const std::size_t parent = index_of(kJointParent[j]);
        if (!is_measured_bone(joint) || !aim.seen[j] || !aim.seen[parent]) continue;
        const double metres = glm::length(aim.joint_m[j] - aim.joint_m[parent]);
        // Neither a bone of nobody's, nor two joints in one place.
        if (!(metres > 0.02 && metres < 1.2)) continue;
        length[j] = metres;
        seen += metres;
        at_rest += rest_->length_m[j];
    }
    const double share = 1 - std::exp(-dt_s / limits_.scale_time_s);
    if (at_rest > 0.5) {
        const double wanted = std::clamp(seen / at_rest, limits_.scale_low, limits_.scale_high);
        scale_ = scaled_ ? glm::mix(scale_, wanted, share) : wanted;
        scaled_ = true;
    }
    for (std::size_t j = 1; j < kJointCount; ++j) {
        if (!(length[j] > 0)) continue;
        const double wanted = std::clamp(length[j] / (scale_ * rest_->length_m[j]),
                                         limits_.ratio_low, limits_.ratio_high);
        ratio_[j] = measured_[j] ? glm::mix(ratio_[j], wanted, share) : wanted;
        measured_[j] = true;
    }
    ratio_[0] = ratio_[index_of(Joint::spine)];
}

void Retarget::step(const BodyAim& aim, const RetargetOptions& options, double dt_s) {
    estimate_lengths(aim, options, dt_s);
    const std::optional<glm::dvec3> root = root_of(aim);
    if (!placed_ && !root) return;
    const bool at_once = !placed_;
    if (root) {
        if (root_lost_s_ > 0) root_back_s_ = 0;
        root_lost_s_ = 0;
        const double ramp = std::clamp(root_back_s_ / limits_.return_s, 0.1, 1.0);
        root_back_s_ += dt_s;
        const glm::dvec3 way = *root - root_m_;
        const double far = glm::length(way);
        const double reach = limits_.move_rate_m * ramp * dt_s;
        root_m_ = at_once || far <= reach ? *root : root_m_ + way * (reach / far);
    } else {
        root_lost_s_ += dt_s > 0 ? dt_s : 1e-9;
    }
    if (at_once) {
        for (Segment& s : segment_) s = {.back_s = 1e9};
        for (std::size_t j = 0; j < kJointCount; ++j) segment_[j].local = ease_[j];
    }
    placed_ = true;
    solve(aim, dt_s, at_once);
    if (options.floor_y_m) stand_on(aim, *options.floor_y_m, dt_s, at_once);
}

void Retarget::solve(const BodyAim& aim, double dt_s, bool at_once) {
    joint_m_[0] = root_m_;
    solve_trunk(aim, dt_s, at_once);
    for (int side = 0; side < 2; ++side) {
        solve_arm(aim, side, dt_s, at_once);
        solve_leg(aim, side, dt_s, at_once);
    }
}

void Retarget::solve_trunk(const BodyAim& aim, double dt_s, bool at_once) {
    const RestBody& rest = *rest_;
    const auto bone_or = [&](const std::optional<glm::dvec3>& a,
                             const std::optional<glm::dvec3>& b) { return a ? a : b; };
    const auto whole = bone(aim, Joint::hip_center, Joint::shoulder_center);
    const auto hips = bone(aim, Joint::hip_right, Joint::hip_left);
    const auto shoulders = bone(aim, Joint::shoulder_right, Joint::shoulder_left);
    const auto lower =
        rest.has_spine ? bone_or(bone(aim, Joint::hip_center, Joint::spine), whole) : whole;
    const auto upper =
        rest.has_spine ? bone_or(bone(aim, Joint::spine, Joint::shoulder_center), whole) : whole;
    // Where nothing says which way they face, pelvis and chest face as before, or as each other.
    std::optional<glm::dquat> pelvis;
    if (lower || hips || shoulders) {
        const glm::dvec3 before = turn_[0] * glm::dvec3(1, 0, 0);
        const glm::dvec3 up = lower ? *lower : (upper ? *upper : turn_[0] * rest.axis[0]);
        const glm::dvec3 left = hips ? *hips : (shoulders ? *shoulders : before);
        pelvis = frame_of(up, glm::length(glm::cross(up, left)) > 0.05 ? left : before) *
                 glm::conjugate(frame_of(rest.axis[0], {1, 0, 0}));
    }
    settle(Joint::hip_center, kNoTurn, pelvis, dt_s, at_once);
    const glm::dquat& p = turn_[0];
    turn_[index_of(Joint::spine)] = p;
    place(Joint::spine, p);

    const std::size_t c = index_of(Joint::shoulder_center);
    std::optional<glm::dquat> chest;
    if (upper) {
        const glm::dvec3 way = within_cone(glm::conjugate(p) * *upper, rest.axis[c], 80 * kDegree);
        chest = shortest_arc(rest.axis[c], way, {1, 0, 0});
        if (shoulders) {
            const glm::dvec3 line = glm::conjugate(p) * *shoulders;
            if (glm::length(glm::cross(way, line)) > 0.05) {
                const double twist = angle_about(way, *chest * glm::dvec3(1, 0, 0), line);
                chest = about(way, std::clamp(twist, -75 * kDegree, 75 * kDegree)) * *chest;
            }
        }
    }
    settle(Joint::shoulder_center, p, chest, dt_s, at_once);
    place(Joint::shoulder_center, turn_[c]);

    std::optional<glm::dquat> head;
    if (const auto way = bone(aim, Joint::shoulder_center, Joint::head)) {
        const glm::dvec3& axis = rest.axis[index_of(Joint::head)];
        head = swing(Joint::head, within_cone(glm::conjugate(turn_[c]) * *way, axis, 75 * kDegree));
    }
    settle(Joint::head, turn_[c], head, dt_s, at_once);
    place(Joint::head, turn_[index_of(Joint::head)]);

    for (int side = 0; side < 2; ++side) {
        // Collar bones, and the bones within the pelvis, which no joint of the rig turns.
        for (const auto& [from, to, cone] :
             {std::tuple{Joint::shoulder_center, sided(Joint::shoulder_left, side), 35 * kDegree},
              std::tuple{Joint::hip_center, sided(Joint::hip_left, side), 15 * kDegree}}) {
            std::optional<glm::dquat> wanted;
            const glm::dquat& t = turn_[index_of(from)];
            if (const auto way = bone(aim, from, to)) {
                wanted =
                    swing(to, within_cone(glm::conjugate(t) * *way, rest.axis[index_of(to)], cone));
            }
            settle(to, t, wanted, dt_s, at_once);
            place(to, turn_[index_of(to)]);
        }
    }
}

void Retarget::solve_arm(const BodyAim& aim, int side, double dt_s, bool at_once) {
    const RestBody& rest = *rest_;
    const Joint shoulder = sided(Joint::shoulder_left, side);
    const Joint elbow = sided(Joint::elbow_left, side);
    const Joint wrist = sided(Joint::wrist_left, side);
    const Joint hand = sided(Joint::hand_left, side);
    const glm::dquat chest = turn_[index_of(Joint::shoulder_center)];
    const auto to_chest = glm::conjugate(chest);
    const auto upper = bone(aim, shoulder, elbow);
    const auto lower = bone(aim, elbow, wrist);
    std::optional<glm::dquat> arm;
    double twist = segment_[index_of(elbow)].twist_rad;
    if (upper) {
        // Arms reach everywhere but far behind the back.
        const glm::dvec3 middle = glm::normalize(glm::dvec3(side == 0 ? 0.6 : -0.6, -0.2, 0.75));
        const glm::dvec3 way = within_cone(to_chest * *upper, middle, 130 * kDegree);
        arm = swing(elbow, way);
        if (lower) {
            const glm::dvec3 bent = glm::cross(way, to_chest * *lower);
            // A straight arm has no plane.
            const double sure = ease_between(0.12, 0.35, glm::length(bent));
            const double found = unwound(angle_about(way, *arm * rest.hinge[index_of(elbow)], bent),
                                         segment_[index_of(elbow)].twist_rad, 110 * kDegree);
            twist = sure * found;
        }
        arm = *arm * about(rest.axis[index_of(elbow)], twist);
    }
    settle(elbow, chest, arm, dt_s, at_once, twist);
    place(elbow, turn_[index_of(elbow)]);

    const glm::dquat& parent = turn_[index_of(elbow)];
    std::optional<glm::dquat> forearm;
    if (lower) {
        forearm = swing(wrist, within_cone(glm::conjugate(parent) * *lower,
                                           rest.axis[index_of(elbow)], 160 * kDegree));
    }
    settle(wrist, parent, forearm, dt_s, at_once);
    place(wrist, turn_[index_of(wrist)]);

    std::optional<glm::dquat> palm;
    if (const auto way = bone(aim, wrist, hand)) {
        palm = swing(hand, within_cone(glm::conjugate(turn_[index_of(wrist)]) * *way,
                                       rest.axis[index_of(wrist)], 85 * kDegree));
    }
    settle(hand, turn_[index_of(wrist)], palm, dt_s, at_once);
    place(hand, turn_[index_of(hand)]);
}

void Retarget::solve_leg(const BodyAim& aim, int side, double dt_s, bool at_once) {
    const RestBody& rest = *rest_;
    const Joint hip = sided(Joint::hip_left, side);
    const Joint knee = sided(Joint::knee_left, side);
    const Joint ankle = sided(Joint::ankle_left, side);
    const Joint foot = sided(Joint::foot_left, side);
    const glm::dquat pelvis = turn_[0];
    const auto to_pelvis = glm::conjugate(pelvis);
    const auto thigh = bone(aim, hip, knee);
    const auto shin = bone(aim, knee, ankle);
    const auto toes = bone(aim, ankle, foot);
    std::optional<glm::dquat> leg;
    double twist = segment_[index_of(knee)].twist_rad;
    if (thigh) {
        const glm::dvec3 middle = glm::normalize(glm::dvec3(side == 0 ? 0.15 : -0.15, -0.6, 0.75));
        const glm::dvec3 way = within_cone(to_pelvis * *thigh, middle, 120 * kDegree);
        leg = swing(knee, way);
        if (shin) {
            const glm::dvec3 axis = *leg * rest.hinge[index_of(knee)];
            const glm::dvec3 bent = glm::cross(way, to_pelvis * *shin);
            const double sure = ease_between(0.12, 0.35, glm::length(bent));
            const double before = segment_[index_of(knee)].twist_rad;
            const double found = unwound(angle_about(way, axis, bent), before, 75 * kDegree);
            double straight = 0;
            // Of a straight leg, the foot tells.
            if (toes) {
                const glm::dvec3 out = glm::cross(to_pelvis * *toes, to_pelvis * *shin);
                straight = ease_between(0.3, 0.7, glm::length(out)) *
                           unwound(angle_about(way, axis, out), before, 50 * kDegree);
            }
            twist = glm::mix(straight, found, sure);
        }
        leg = *leg * about(rest.axis[index_of(knee)], twist);
    }
    settle(knee, pelvis, leg, dt_s, at_once, twist);
    place(knee, turn_[index_of(knee)]);

    const glm::dquat& parent = turn_[index_of(knee)];
    std::optional<glm::dquat> lower;
    if (shin) {
        lower = swing(ankle, within_cone(glm::conjugate(parent) * *shin, rest.axis[index_of(knee)],
                                         160 * kDegree));
    }
    settle(ankle, parent, lower, dt_s, at_once);
    place(ankle, turn_[index_of(ankle)]);

    std::optional<glm::dquat> sole;
    if (toes) {
        sole = swing(foot, within_cone(glm::conjugate(turn_[index_of(ankle)]) * *toes,
                                       rest.axis[index_of(foot)], 75 * kDegree));
    }
    settle(foot, turn_[index_of(ankle)], sole, dt_s, at_once);
    place(foot, turn_[index_of(foot)]);
}

std::vector<glm::mat4> Retarget::object_from_bind(const glm::dvec3& origin_m) const {
    const RestBody& rest = *rest_;
    std::vector<glm::mat4> pose;
    pose.reserve(rest.drives.size());
    for (const RigDrive& drive : rest.drives) {
        const std::size_t s = index_of(drive.segment);
        // The pelvis' bone begins in its own joint.
        const std::size_t start = s == 0 ? 0 : index_of(kJointParent[s]);
        const glm::dvec3& axis = rest.axis[s];
        glm::dquat turn = turn_[s];
        if (drive.segment == Joint::shoulder_center) {
            turn = mix_turns(turn_[0], turn, drive.share);
        } else if (rest.hinge[s] != glm::dvec3(0)) {
            turn = turn * about(axis, -segment_[s].twist_rad * (1 - drive.share));
        }
        const double stretch = is_measured_bone(drive.segment) || s == 0 ? ratio_[s] : 1.0;
        const auto stretched = [&](const glm::dvec3& v) {
            return v + axis * ((stretch - 1) * glm::dot(axis, v));
        };
        const glm::dvec3 at = (joint_m_[start] - origin_m) / scale_ +
                              turn_[s] * stretched(drive.rest_m - rest.joint_m[start]);
        glm::dmat4 m(1.0);
        for (int column = 0; column < 3; ++column) {
            glm::dvec3 unit(0);
            unit[column] = 1;
            m[column] = glm::dvec4(turn * stretched(unit), 0.0);
        }
        const glm::dvec3 moved = at - turn * stretched(drive.rest_m);
        m[3] = glm::dvec4(moved, 1.0);
        pose.emplace_back(m);
    }
    return pose;
}

}  // namespace kino
