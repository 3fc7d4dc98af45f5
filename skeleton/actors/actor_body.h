#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/body.h"
#include "skeleton/actors/actor_bone.h"
#include "skeleton/actors/actor_look.h"
#include "skeleton/actors/base_mesh.h"
#include "skeleton/forest/body_part.h"

namespace kino {

/// One person, dressed, in the pose of the base mesh: axes as there, metres.
struct ActorBody {
    std::vector<glm::vec3> vertex_m;
    std::vector<BoneWeights> weights;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<BodyPart> part;       ///< of each triangle
    std::size_t first_two_sided = 0;  ///< triangles from here on are open cloth
    std::array<glm::dvec3, kActorBoneCount> head_m;
    std::array<glm::dvec3, kJointCount> joint_m;

    [[nodiscard]] const glm::dvec3& joint(Joint j) const {
        return joint_m[static_cast<std::size_t>(j)];
    }
};

[[nodiscard]] ActorBody make_actor_body(const ActorLook& look);

/// The part of each triangle of the base mesh: the bone that moves most of it and, along the bone,
/// the half in which its middle lies; the trunk by the sagittal plane.
[[nodiscard]] const std::vector<BodyPart>& base_mesh_parts();

/// Which bone carries a joint.
[[nodiscard]] std::size_t bone_of_joint(Joint joint);

}  // namespace kino
