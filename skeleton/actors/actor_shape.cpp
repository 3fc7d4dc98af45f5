#include "skeleton/actors/actor_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/actors/actor_body.h"

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

// How a bone's flesh and the bones that hang on it stretch; both linear about the bone's head.
struct Stretch {
    dmat3 flesh{1}, bones{1};
};

dmat3 diagonal(double x, double y, double z) {
    return {{x, 0, 0}, {0, y, 0}, {0, 0, z}};
}

// `length` along the bone, `girth` across.
dmat3 limb(const dvec3& along, double length, double girth) {
    const dvec3 a = glm::normalize(along);
    return dmat3(girth) + glm::outerProduct(a, a) * (length - girth);
}

std::array<Stretch, kActorBoneCount> stretches(const ActorLook& look) {
    const BaseMesh& mesh = base_mesh();
    const double w = look.weight, muscle = look.muscle;
    const double thin = std::min(w, 0.0), fat = std::max(w, 0.0);
    std::array<Stretch, kActorBoneCount> out;
    const auto trunk = [&](ActorBone bone, double width, double more_x, double more_z) {
        const double x = width * (1 + more_x * fat + 0.07 * thin);
        out[bone_index(bone)] = {diagonal(x, look.trunk, 1 + more_z * fat + 0.08 * thin),
                                 diagonal(width, look.trunk, 1)};
    };
    trunk(ActorBone::pelvis, look.hips, 0.09, 0.12);
    trunk(ActorBone::waist, look.waist, 0.15, 0.17);
    trunk(ActorBone::chest, look.shoulders, 0.09, 0.13);
    const double neck = 1 + 0.10 * fat + 0.05 * thin + 0.10 * muscle;
    out[bone_index(ActorBone::neck)] = {diagonal(neck, look.trunk, neck), dmat3(look.trunk)};
    const double jowls = 1 + 0.04 * fat;
    out[bone_index(ActorBone::head)] = {diagonal(look.head * jowls, look.head, look.head),
                                        dmat3(look.head)};
    for (int side = 0; side < 2; ++side) {
        const auto set = [&](ActorBone bone, double length, double girth) {
            const std::size_t i = bone_index(bone, side);
            const dmat3 m = limb(mesh.tail_m[i] - mesh.head_m[i], length, girth);
            out[i] = {m, m};
        };
        set(ActorBone::clavicle, look.shoulders, 1 + 0.08 * fat + 0.08 * muscle);
        const double arm = 1 + 0.13 * fat + 0.10 * thin + 0.22 * muscle;
        set(ActorBone::upper_arm_high, look.arms, arm);
        set(ActorBone::upper_arm_low, look.arms, arm);
        const double forearm = 1 + 0.07 * fat + 0.06 * thin + 0.12 * muscle;
        set(ActorBone::forearm_high, look.arms, forearm);
        set(ActorBone::forearm_low, look.arms, 0.5 + 0.5 * forearm);
        const double thigh = 1 + 0.13 * fat + 0.10 * thin + 0.10 * muscle;
        set(ActorBone::thigh_high, look.legs, thigh);
        set(ActorBone::thigh_low, look.legs, thigh);
        const double shin = 1 + 0.08 * fat + 0.06 * thin + 0.08 * muscle;
        set(ActorBone::shin_high, look.legs, shin);
        set(ActorBone::shin_low, look.legs, 0.4 + 0.6 * shin);
        for (const ActorBone b :
             {ActorBone::hand, ActorBone::fingers, ActorBone::finger_tips, ActorBone::thumb}) {
            set(b, look.hands, look.hands);
        }
        for (const ActorBone b : {ActorBone::foot, ActorBone::toes}) set(b, look.feet, look.feet);
    }
    return out;
}

double bump(const dvec3& p, const dvec3& at, const dvec3& width) {
    const dvec3 d = (p - at) / width;
    return std::exp(-glm::dot(d, d) / 2);
}

// Belly and breasts stand out of the base's front.
dvec3 bulge(const ActorLook& look, const dvec3& base, double trunk_share) {
    if (trunk_share <= 0) return dvec3(0);
    const double front = smooth_step(-0.02, 0.10, base.z);
    const double belly = bump(base, {0, 1.06, 0.10}, {0.13, 0.105, 0.2}) * look.belly_m;
    const double bust = (bump(base, {0.085, 1.245, 0.1}, {0.05, 0.05, 0.2}) +
                         bump(base, {-0.085, 1.245, 0.1}, {0.05, 0.05, 0.2})) *
                        look.bust_m;
    const dvec3 out(0.35 * belly * std::clamp(base.x / 0.13, -1.0, 1.0), -0.1 * belly,
                    belly + bust);
    return out * (front * trunk_share);
}

}  // namespace

double smooth_step(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

std::vector<dvec3> mesh_normals(const std::vector<dvec3>& vertex_m,
                                const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::vector<dvec3> normals(vertex_m.size(), dvec3(0));
    for (const auto& t : triangles) {
        const dvec3 n =
            glm::cross(vertex_m[t[1]] - vertex_m[t[0]], vertex_m[t[2]] - vertex_m[t[0]]);
        for (const std::uint32_t v : t) normals[v] += n;
    }
    for (dvec3& n : normals) n = glm::dot(n, n) > 0 ? glm::normalize(n) : dvec3(0, 1, 0);
    return normals;
}

ActorShape shape_body(const ActorLook& look) {
    const BaseMesh& mesh = base_mesh();
    const auto stretch = stretches(look);
    ActorShape shape;
    shape.head_m[0] = mesh.head_m[0];
    for (std::size_t b = 1; b < kActorBoneCount; ++b) {
        const std::size_t up = kActorBoneParent[b];
        shape.head_m[b] = shape.head_m[up] + stretch[up].bones * (mesh.head_m[b] - mesh.head_m[up]);
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const std::size_t b = bone_of_joint(static_cast<Joint>(j));
        shape.joint_m[j] = shape.head_m[b] + stretch[b].bones * (mesh.joint_m[j] - mesh.head_m[b]);
    }
    shape.vertex_m.reserve(mesh.vertex_m.size());
    double floor = 1e9, top = -1e9;
    for (std::size_t i = 0; i < mesh.vertex_m.size(); ++i) {
        const dvec3& base = mesh.vertex_m[i];
        dvec3 p(0);
        double trunk = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const double weight = mesh.weights[i].weight[k];
            const std::size_t b = mesh.weights[i].bone[k];
            p += weight * (shape.head_m[b] + stretch[b].flesh * (base - mesh.head_m[b]));
            if (b <= bone_index(ActorBone::chest)) trunk += weight;
        }
        shape.vertex_m.push_back(p + bulge(look, base, trunk));
        floor = std::min(floor, p.y);
        top = std::max(top, p.y);
    }
    const double scale = look.stature_m / (top - floor);
    const auto settle = [&](dvec3& p) { p = (p - dvec3(0, floor, 0)) * scale; };
    for (dvec3& p : shape.vertex_m) settle(p);
    for (dvec3& p : shape.head_m) settle(p);
    for (dvec3& p : shape.joint_m) settle(p);
    return shape;
}

}  // namespace kino
