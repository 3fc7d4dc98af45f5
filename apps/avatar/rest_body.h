#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "apps/avatar/avatar_rig.h"
#include "base/body.h"

namespace kino {

template <class T>
using PerJoint = std::array<T, kJointCount>;

[[nodiscard]] constexpr std::size_t index_of(Joint joint) {
    return static_cast<std::size_t>(joint);
}

/// A segment is named by the joint its bone ends in; hip_center names the pelvis, whose bone ends
/// in the spine. How a rig's joint moves with its segment.
struct RigDrive {
    Joint segment = Joint::hip_center;
    /// How much of the segment's twist (limbs) or of its bend against the pelvis (chest) the joint
    /// takes.
    double share = 1;
    glm::dvec3 rest_m{0};  ///< object space
};

/// What retargeting knows of a rig: where the body's joints are at rest, object space. Joints that
/// the rig lacks are where they would be.
struct RestBody {
    PerJoint<glm::dvec3> joint_m{};
    PerJoint<glm::dvec3> axis{};   ///< of the bone that ends in the joint, unit; pelvis: up
    PerJoint<double> length_m{};   ///< of that bone; pelvis: of the bone to the spine
    PerJoint<glm::dvec3> hinge{};  ///< elbow and knee segments: axis the next bone bends about
    std::array<glm::dvec3, 2> heel_m{}, toe_m{};  ///< ends of the soles, left and right
    bool has_spine = true;                        ///< false: pelvis and chest are one
    double height_m = 1.75;
    std::vector<RigDrive> drives;  ///< one for each of the rig's joints
};

[[nodiscard]] RestBody make_rest_body(const AvatarRig& rig);

/// Positions of the rig's joints at rest, object space.
[[nodiscard]] std::vector<glm::dvec3> rest_positions(const AvatarRig& rig);

}  // namespace kino
