#include "skeleton/motion/bone_mesh.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace kino::motion_export {
namespace {

void append_bone(BoneMesh& mesh, const glm::dvec3& begin, const glm::dvec3& bone, int node) {
    const double length = glm::length(bone);
    if (!(length > 0)) return;
    const glm::dvec3 along = bone / length;
    const glm::dvec3 aside = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 a = glm::normalize(glm::cross(along, aside));
    const glm::dvec3 b = glm::cross(along, a);
    const double radius = 0.1 * length;
    const glm::dvec3 waist = begin + bone * 0.2;
    const auto first = static_cast<std::uint16_t>(mesh.vertices.size());
    for (const glm::dvec3& p : {begin, begin + bone, waist + a * radius, waist + b * radius,
                                waist - a * radius, waist - b * radius}) {
        mesh.vertices.push_back({p, node});
    }
    for (int i = 0; i < 4; ++i) {
        const int here = 2 + i, next = 2 + (i + 1) % 4;
        for (const int v : {0, next, here, 1, here, next}) {
            mesh.indices.push_back(static_cast<std::uint16_t>(first + v));
        }
    }
}

}  // namespace

std::array<glm::dvec3, kNodeCount> rest_positions(const SkeletalMotion& motion) {
    std::array<glm::dvec3, kNodeCount> places{};
    for (const int n : tree_order()) {
        const int parent = rest_nodes()[n].parent;
        if (parent >= 0) places[n] = places[parent] + motion.offset_m[n];
    }
    return places;
}

BoneMesh bone_mesh(const SkeletalMotion& motion) {
    BoneMesh mesh;
    const auto places = rest_positions(motion);
    for (int n = 1; n < static_cast<int>(kNodeCount); ++n) {
        const int parent = rest_nodes()[n].parent;
        append_bone(mesh, places[parent], motion.offset_m[n], parent);
        append_bone(mesh, places[n], rest_nodes()[n].direction * tip_m(n), n);
    }
    return mesh;
}

}  // namespace kino::motion_export
