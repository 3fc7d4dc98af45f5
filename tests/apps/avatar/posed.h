#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "apps/avatar/rest_body.h"
#include "people.h"
#include "tests/reference/skinning_reference.h"

namespace kino::test {

[[nodiscard]] inline std::shared_ptr<const AvatarRig> rig_called(const std::string& name) {
    auto rig = open_avatar(name);
    EXPECT_TRUE(rig) << (rig ? "" : rig.error().to_string());
    return rig ? *rig : nullptr;
}

[[nodiscard]] inline Scene filled(const AvatarTroupe& troupe, std::uint32_t first_id = 10) {
    Scene scene;
    troupe.fill(scene, first_id);
    return scene;
}

/// Where a node takes the rig's joint that is `joint` of the body, world; empty: it has none.
[[nodiscard]] inline std::optional<glm::dvec3> posed_joint(const AvatarRig& rig,
                                                           const MeshNode& node, Joint joint) {
    const int r = rig.of_joint[index_of(joint)];
    if (r < 0) return std::nullopt;
    const glm::dvec3 rest = rest_positions(rig)[static_cast<std::size_t>(r)];
    const glm::dmat4 m =
        node.world_from_object * glm::dmat4((*node.pose)[static_cast<std::size_t>(r)]);
    return glm::dvec3(m * glm::dvec4(rest, 1));
}

[[nodiscard]] inline double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / 3.14159265358979;
}

/// Angle between the avatar's bone and the person's; 0 where the rig has not both joints.
[[nodiscard]] inline double bone_error_deg(const AvatarRig& rig, const MeshNode& node,
                                           const PosedBody& person, Joint joint) {
    const Joint parent = kJointParent[index_of(joint)];
    const auto to = posed_joint(rig, node, joint);
    const auto from = posed_joint(rig, node, parent);
    if (!to || !from) return 0;
    return degrees_between(*to - *from, person[joint] - person[parent]);
}

/// Every number of every node is finite and no vertex is farther than `reach_m` from its node.
inline void expect_sane(const Scene& scene, double reach_m = 4) {
    for (const MeshNode& node : scene.meshes) {
        for (int c = 0; c < 4; ++c) {
            for (int r = 0; r < 4; ++r) ASSERT_TRUE(std::isfinite(node.world_from_object[c][r]));
        }
        for (const glm::mat4& m : *node.pose) {
            for (int c = 0; c < 4; ++c) {
                for (int r = 0; r < 4; ++r) ASSERT_TRUE(std::isfinite(m[c][r]));
            }
            ASSERT_LT(glm::length(m * glm::vec4(0, 1, 0, 1)), reach_m);
        }
    }
}

}  // namespace kino::test
