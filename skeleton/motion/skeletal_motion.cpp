#include "skeleton/motion/skeletal_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

namespace kino::motion_export {
namespace {

using glm::dmat3;
using glm::dquat;
using glm::dvec3;

constexpr double kShortestBoneM = 1e-6;  ///< below this a bone has no direction
constexpr double kThinnestSine = 0.05;   ///< 3 degrees: below this two bones span no plane

int index(Joint j) {
    return static_cast<int>(j);
}

std::optional<double> median(std::vector<double> values) {
    if (values.empty()) return std::nullopt;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::optional<dvec3> direction(const dvec3& v) {
    const double length = glm::length(v);
    if (!(length > kShortestBoneM)) return std::nullopt;
    return v / length;
}

dvec3 any_normal(const dvec3& v) {
    const dvec3 a = glm::abs(v);
    const dvec3 axis = a.x <= a.y && a.x <= a.z ? dvec3(1, 0, 0)
                       : a.y <= a.z             ? dvec3(0, 1, 0)
                                                : dvec3(0, 0, 1);
    return glm::normalize(glm::cross(v, axis));
}

/// The rotation with the least angle that takes `from` to `to`, both of unit length. For opposite
/// ones every axis across is as good: the one nearest to `hint`'s keeps the motion smooth.
dquat least_rotation(const dvec3& from, const dvec3& to, const dquat& hint) {
    const double w = 1 + glm::dot(from, to);
    if (w > 1e-9) {
        const dvec3 c = glm::cross(from, to);
        return glm::normalize(dquat(w, c.x, c.y, c.z));
    }
    const dvec3 wish(hint.x, hint.y, hint.z);
    const dvec3 across = wish - from * glm::dot(wish, from);
    const dvec3 axis = direction(across).value_or(any_normal(from));
    return {0, axis.x, axis.y, axis.z};
}

/// y along `up`, x as near as can be to `left`.
dquat frame_of(const dvec3& up, const dvec3& left_across) {
    return glm::normalize(glm::quat_cast(dmat3(left_across, up, glm::cross(left_across, up))));
}

class Poser {
  public:
    Poser(const std::array<double, kJointCount>& bone_m, const std::array<bool, kJointCount>& ever)
        : bone_m_(bone_m), ever_(ever) {
        world_.fill(dquat(1, 0, 0, 0));
        twist_free_ = world_;
    }

    SkeletonPose pose(const TrackFrame& frame) {
        target_m_ = frame.world_m;
        const dquat pelvis_before = world_[0], chest_before = world_[1];
        // The trunk: hips tell the pelvis's twist, shoulders the chest's; each stands in for the
        // other where a person shows only half.
        turn_trunk(
            0, pelvis_before, {Joint::spine},
            {{{Joint::hip_left, Joint::hip_right}, {Joint::shoulder_left, Joint::shoulder_right}}});
        place_unseen(Joint::spine, 0);
        turn_trunk(
            1, first_ ? world_[0] : chest_before, {Joint::shoulder_center},
            {{{Joint::shoulder_left, Joint::shoulder_right}, {Joint::hip_left, Joint::hip_right}}});
        place_unseen(Joint::shoulder_center, 1);
        world_[2] = world_[1];
        constexpr int kHead = 3;
        aim(kNeck, 2, kHead);
        world_[kHead] = world_[kNeck];
        limb(kLeftClavicle, 2, index(Joint::shoulder_left));
        limb(kRightClavicle, 2, index(Joint::shoulder_right));
        limb(kLeftPelvis, 0, index(Joint::hip_left));
        limb(kRightPelvis, 0, index(Joint::hip_right));

        SkeletonPose pose;
        pose.root_m = target_m_[0];
        for (const int n : tree_order()) {
            const int parent = rest_nodes()[n].parent;
            pose.local[n] =
                parent < 0 ? world_[n] : glm::normalize(glm::conjugate(world_[parent]) * world_[n]);
        }
        first_ = false;
        return pose;
    }

  private:
    using Line = std::array<Joint, 2>;  ///< left end, right end

    [[nodiscard]] bool ever(Joint j) const { return ever_[index(j)]; }
    [[nodiscard]] const dvec3& at(Joint j) const { return target_m_[index(j)]; }

    /// Orients a trunk node: y to `above`, x by the first line that spans a plane with it; without
    /// one the frame before turns by the least rotation.
    void turn_trunk(int node, const dquat& before, Joint above, const std::array<Line, 2>& lines) {
        const dvec3 y_before = before * dvec3(0, 1, 0);
        const std::optional<dvec3> seen =
            ever(above) ? direction(at(above) - target_m_[node]) : std::nullopt;
        const dvec3 up = seen.value_or(y_before);
        for (const auto& [left, right] : lines) {
            if (!ever(left) || !ever(right)) continue;
            const auto line = direction(at(left) - at(right));
            if (!line) continue;
            const dvec3 across = *line - up * glm::dot(*line, up);
            const double sine = glm::length(across);
            if (sine < kThinnestSine) continue;
            world_[node] = frame_of(up, across / sine);
            return;
        }
        world_[node] = glm::normalize(least_rotation(y_before, up, before) * before);
    }

    void place_unseen(Joint j, int from) {
        if (ever(j)) return;
        target_m_[index(j)] =
            target_m_[from] + world_[from] * (rest_nodes()[index(j)].direction * bone_m_[index(j)]);
    }

    /// Turns `node`, which lies on its bone's beginning, so that its bone reaches for `end`, with
    /// the least twist from `reference`.
    void aim(int node, int reference, int end) {
        const int begin = node < static_cast<int>(kJointCount) ? node : rest_nodes()[node].parent;
        const dquat& base = world_[reference];
        const dvec3 rest = rest_nodes()[end].direction;
        std::optional<dvec3> seen;
        if (ever_[end]) seen = direction(target_m_[end] - target_m_[begin]);
        // Without a direction the bone stays as it was to its reference: at first, at rest.
        if (seen) {
            const dvec3 wanted = glm::normalize(glm::conjugate(base) * *seen);
            twist_free_[node] = least_rotation(rest, wanted, twist_free_[node]);
        }
        world_[node] = glm::normalize(base * twist_free_[node]);
        if (!ever_[end]) {
            target_m_[end] = target_m_[begin] + world_[node] * (rest * bone_m_[end]);
        }
    }

    /// A girdle bone and the three joints behind it. The first long bone refers to the trunk, so
    /// that a shrug does not twist the arm.
    void limb(int girdle, int trunk, int first) {
        aim(girdle, trunk, first);
        aim(first, trunk, first + 1);
        aim(first + 1, first, first + 2);
        aim(first + 2, first + 1, first + 3);
        world_[first + 3] = world_[first + 2];
    }

    std::array<double, kJointCount> bone_m_;
    std::array<bool, kJointCount> ever_;
    std::array<dvec3, kJointCount> target_m_{};
    std::array<dquat, kNodeCount> world_;
    std::array<dquat, kNodeCount> twist_free_;  ///< to the reference
    bool first_ = true;
};

}  // namespace

std::array<double, kJointCount> bone_lengths(const JointTrack& track) {
    std::array<double, kJointCount> lengths{};
    std::vector<double> ratios;
    for (std::size_t j = 1; j < kJointCount; ++j) {
        const auto parent = static_cast<std::size_t>(kJointParent[j]);
        std::vector<double> seen;
        for (const TrackFrame& f : track.frames) {
            if (!f.seen[j] || !f.seen[parent]) continue;
            seen.push_back(glm::length(f.world_m[j] - f.world_m[parent]));
        }
        lengths[j] = median(std::move(seen)).value_or(0);
        if (lengths[j] > kShortestBoneM) {
            ratios.push_back(lengths[j] / usual_bone_m(static_cast<Joint>(j)));
        }
    }
    const double ratio = median(std::move(ratios)).value_or(1);
    for (std::size_t j = 1; j < kJointCount; ++j) {
        if (lengths[j] > kShortestBoneM) continue;
        lengths[j] = ratio * usual_bone_m(static_cast<Joint>(j));
    }
    return lengths;
}

SkeletalMotion rotations_of(const JointTrack& track, const std::array<double, kJointCount>& bone_m,
                            const std::array<bool, kJointCount>& ever, double rate_hz) {
    SkeletalMotion motion;
    motion.rate_hz = rate_hz;
    for (std::size_t j = 1; j < kJointCount; ++j) {
        motion.offset_m[j] = rest_nodes()[j].direction * bone_m[j];
    }
    Poser poser(bone_m, ever);
    motion.poses.reserve(track.frames.size());
    for (const TrackFrame& frame : track.frames) motion.poses.push_back(poser.pose(frame));
    return motion;
}

std::array<dvec3, kNodeCount> node_positions(const SkeletalMotion& motion,
                                             const SkeletonPose& pose) {
    std::array<dvec3, kNodeCount> place;
    std::array<dquat, kNodeCount> turn;
    for (const int n : tree_order()) {
        const int parent = rest_nodes()[n].parent;
        place[n] = parent < 0 ? pose.root_m : place[parent] + turn[parent] * motion.offset_m[n];
        turn[n] = parent < 0 ? pose.local[n] : turn[parent] * pose.local[n];
    }
    return place;
}

}  // namespace kino::motion_export
