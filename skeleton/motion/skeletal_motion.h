#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/motion/joint_track.h"
#include "skeleton/motion/rest_pose.h"

namespace kino::motion_export {

/// Rotations of all nodes, each relative to its parent, of unit length and either sign.
struct SkeletonPose {
    glm::dvec3 root_m{0};  ///< hip centre, world
    std::array<glm::dquat, kNodeCount> local;
};

/// A skeleton of constant bones and its motion at a constant rate, world space.
struct SkeletalMotion {
    double rate_hz = 30;
    std::array<glm::dvec3, kNodeCount> offset_m{};  ///< from the parent, at rest; 0 for the root
    std::vector<SkeletonPose> poses;
};

/// The bone that ends in each joint, metres: median over the frames where both ends were seen; a
/// bone never seen is the usual one times the median ratio of the others to theirs.
[[nodiscard]] std::array<double, kJointCount> bone_lengths(const JointTrack& track);

/// Turns positions into rotations: the trunk by its planes, everything else by the least twist.
/// `track` is bridged and resampled; `ever` says which joints were seen at all.
[[nodiscard]] SkeletalMotion rotations_of(const JointTrack& track,
                                          const std::array<double, kJointCount>& bone_m,
                                          const std::array<bool, kJointCount>& ever,
                                          double rate_hz);

/// Forward kinematics, world space, metres.
[[nodiscard]] std::array<glm::dvec3, kNodeCount> node_positions(const SkeletalMotion& motion,
                                                                const SkeletonPose& pose);

}  // namespace kino::motion_export
