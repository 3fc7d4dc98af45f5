#include "tests/reference/skinning_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace kino::test {
namespace {

struct DualQuat {
    glm::dquat real{1, 0, 0, 0};
    glm::dquat dual{0, 0, 0, 0};
};

/// Of the motion p -> rotation p + translation.
DualQuat dual_of(const glm::dquat& rotation, const glm::dvec3& translation) {
    const glm::dquat t(0, translation.x, translation.y, translation.z);
    return {rotation, t * rotation * 0.5};
}

double dot4(const glm::dquat& a, const glm::dquat& b) {
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

glm::dvec3 applied(const DualQuat& q, const glm::dvec3& p) {
    const glm::dquat t = q.dual * glm::conjugate(q.real) * 2.0;
    return glm::mat3_cast(q.real) * p + glm::dvec3(t.x, t.y, t.z);
}

}  // namespace

PolarParts polar_parts(const glm::dmat3& m) {
    glm::dmat3 r = m;
    for (int i = 0; i < 60; ++i) {
        const glm::dmat3 next = 0.5 * (r + glm::transpose(glm::inverse(r)));
        double change = 0;
        for (int c = 0; c < 3; ++c) change = std::max(change, glm::length(next[c] - r[c]));
        r = next;
        if (change < 1e-15) break;
    }
    return {r, glm::transpose(r) * m};
}

SkinnedVertex skin_linear(const SkinVertex& vertex) {
    glm::dmat4 m(0.0);
    for (std::size_t k = 0; k < 4; ++k) m += vertex.weight[k] * vertex.joint[k];
    return {glm::dvec3(m * glm::dvec4(vertex.position, 1.0)),
            glm::normalize(glm::transpose(glm::inverse(glm::dmat3(m))) * vertex.normal)};
}

SkinnedVertex skin_dual(const SkinVertex& vertex, bool opposite) {
    std::size_t strongest = 0;
    for (std::size_t k = 1; k < 4; ++k) {
        if (vertex.weight[k] > vertex.weight[strongest]) strongest = k;
    }
    std::array<glm::dquat, 4> turn;
    for (std::size_t k = 0; k < 4; ++k) {
        turn[k] = glm::quat_cast(polar_parts(glm::dmat3(vertex.joint[k])).rotation);
    }
    DualQuat sum{glm::dquat(0, 0, 0, 0), glm::dquat(0, 0, 0, 0)};
    glm::dvec3 normal(0);
    for (std::size_t k = 0; k < 4; ++k) {
        const PolarParts parts = polar_parts(glm::dmat3(vertex.joint[k]));
        const glm::dvec3 to(vertex.joint[k] * glm::dvec4(vertex.position, 1.0));
        DualQuat q = dual_of(turn[k], to - parts.rotation * vertex.position);
        const double side = dot4(turn[k], turn[strongest]);
        const bool half_turn = std::abs(side) < 1e-4;
        const double sign = (side < 0) != (half_turn && opposite) ? -1 : 1;
        q = {q.real * (sign * vertex.weight[k]), q.dual * (sign * vertex.weight[k])};
        sum = {sum.real + q.real, sum.dual + q.dual};
        // Normals take the inverse transpose of the stretch; its size counts as the joint's area.
        normal += vertex.weight[k] * glm::determinant(parts.stretch) *
                  (glm::transpose(glm::inverse(parts.stretch)) * vertex.normal);
    }
    const double length = glm::length(sum.real);
    sum = {sum.real * (1 / length), sum.dual * (1 / length)};
    // A unit dual quaternion's parts are orthogonal; only that share of the dual part moves.
    sum.dual = sum.dual + sum.real * -dot4(sum.real, sum.dual);
    return {applied(sum, vertex.position), glm::normalize(glm::mat3_cast(sum.real) * normal)};
}

std::vector<SkinnedVertex> skin_mesh(const MeshNode& node, bool opposite) {
    const MeshAsset& mesh = *node.mesh;
    std::vector<SkinnedVertex> out;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        SkinVertex vertex{glm::dvec3(mesh.positions[v]), glm::dvec3(mesh.normals[v])};
        double sum = 0;
        for (int k = 0; k < 4; ++k) sum += mesh.weights[v][k];
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t joint = sum > 0 ? mesh.joints[v][k] : 0;
            vertex.joint[k] = glm::dmat4((*node.pose)[std::min(joint, node.pose->size() - 1)]);
            vertex.weight[k] =
                sum > 0 ? mesh.weights[v][static_cast<int>(k)] / sum : (k == 0 ? 1.0 : 0.0);
        }
        out.push_back(node.skin == SkinBlend::dual_quaternion ? skin_dual(vertex, opposite)
                                                              : skin_linear(vertex));
    }
    return out;
}

}  // namespace kino::test
