#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/actors/actor_body.h"

namespace kino {
namespace {

BodyPart of_side(BodyPart left, int side) {
    return side == 0 ? left : mirrored(left);
}

// How far a point has got from joint `a` to joint `b`.
double along(const BaseMesh& mesh, Joint a, Joint b, const glm::dvec3& p) {
    const glm::dvec3 line = mesh.joint(b) - mesh.joint(a);
    return glm::dot(p - mesh.joint(a), line) / glm::dot(line, line);
}

BodyPart trunk_part(const BaseMesh& mesh, const glm::dvec3& p) {
    const int side = p.x >= 0 ? 0 : 1;
    const bool high = along(mesh, Joint::hip_center, Joint::shoulder_center, p) > 0.5;
    return of_side(high ? BodyPart::chest_left : BodyPart::belly_left, side);
}

BodyPart part_at(const BaseMesh& mesh, std::size_t bone, const glm::dvec3& p) {
    if (bone == bone_index(ActorBone::head)) return BodyPart::head;
    if (bone == bone_index(ActorBone::neck)) return BodyPart::neck;
    if (bone < bone_index(ActorBone::clavicle)) return trunk_part(mesh, p);
    const std::size_t first = bone_index(ActorBone::clavicle);
    const int side = bone - first < kActorBonesOfSide ? 0 : 1;
    const auto left = static_cast<ActorBone>(bone - (side == 0 ? 0 : kActorBonesOfSide));
    const auto joint = [side](Joint j) {
        return static_cast<Joint>(static_cast<int>(j) + 4 * side);
    };
    const auto half = [&](Joint a, Joint b, BodyPart high, BodyPart low) {
        return of_side(along(mesh, joint(a), joint(b), p) < 0.5 ? high : low, side);
    };
    switch (left) {
        case ActorBone::clavicle:
            if (std::abs(p.x) < 0.82 * mesh.joint(Joint::shoulder_left).x) {
                return trunk_part(mesh, p);
            }
            return of_side(BodyPart::upper_arm_left_high, side);
        case ActorBone::upper_arm_high:
        case ActorBone::upper_arm_low:
            return half(Joint::shoulder_left, Joint::elbow_left, BodyPart::upper_arm_left_high,
                        BodyPart::upper_arm_left_low);
        case ActorBone::forearm_high:
        case ActorBone::forearm_low:
            return half(Joint::elbow_left, Joint::wrist_left, BodyPart::forearm_left_high,
                        BodyPart::forearm_left_low);
        case ActorBone::thigh_high:
        case ActorBone::thigh_low:
            return half(Joint::hip_left, Joint::knee_left, BodyPart::thigh_left_high,
                        BodyPart::thigh_left_low);
        case ActorBone::shin_high:
        case ActorBone::shin_low:
            return half(Joint::knee_left, Joint::ankle_left, BodyPart::shin_left_high,
                        BodyPart::shin_left_low);
        case ActorBone::foot:
        case ActorBone::toes:
            return of_side(BodyPart::foot_left, side);
        default:
            return of_side(BodyPart::hand_left, side);
    }
}

std::vector<BodyPart> find_parts() {
    const BaseMesh& mesh = base_mesh();
    std::vector<BodyPart> parts;
    for (const auto& t : mesh.triangles) {
        std::array<double, kActorBoneCount> share{};
        glm::dvec3 middle(0);
        for (const std::uint32_t v : t) {
            middle += mesh.vertex_m[v] / 3.0;
            for (std::size_t k = 0; k < 4; ++k) {
                share[mesh.weights[v].bone[k]] += mesh.weights[v].weight[k];
            }
        }
        // The bones of a part count together; those of the trunk are one.
        std::array<double, kBodyPartCount> votes{};
        for (std::size_t b = 0; b < kActorBoneCount; ++b) {
            if (share[b] > 0) {
                votes[static_cast<std::size_t>(part_at(mesh, b, middle))] += share[b];
            }
        }
        std::size_t best = 0;
        for (std::size_t p = 1; p < votes.size(); ++p) {
            if (votes[p] > votes[best]) best = p;
        }
        parts.push_back(static_cast<BodyPart>(best));
    }
    return parts;
}

}  // namespace

const std::vector<BodyPart>& base_mesh_parts() {
    static const std::vector<BodyPart> parts = find_parts();
    return parts;
}

std::size_t bone_of_joint(Joint joint) {
    switch (joint) {
        case Joint::hip_center:
            return bone_index(ActorBone::pelvis);
        case Joint::spine:
            return bone_index(ActorBone::waist);
        case Joint::shoulder_center:
            return bone_index(ActorBone::chest);
        case Joint::head:
            return bone_index(ActorBone::head);
        default:
            break;
    }
    const int i = static_cast<int>(joint) - static_cast<int>(Joint::shoulder_left);
    const int side = (i / 4) % 2;
    constexpr ActorBone kArm[] = {ActorBone::upper_arm_high, ActorBone::forearm_high,
                                  ActorBone::hand, ActorBone::hand};
    constexpr ActorBone kLeg[] = {ActorBone::thigh_high, ActorBone::shin_high, ActorBone::foot,
                                  ActorBone::foot};
    return bone_index(i < 8 ? kArm[i % 4] : kLeg[i % 4], side);
}

}  // namespace kino
