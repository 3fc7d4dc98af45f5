#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "viz/scene/scene.h"

namespace kino::test {

/// A rotation and what is left: m = rotation * stretch, by Newton's iteration for the polar
/// decomposition (Higham 1986). For matrices of positive determinant.
struct PolarParts {
    glm::dmat3 rotation{1};
    glm::dmat3 stretch{1};
};
[[nodiscard]] PolarParts polar_parts(const glm::dmat3& m);

/// A vertex and its joints.
struct SkinVertex {
    glm::dvec3 position{0};
    glm::dvec3 normal{0, 1, 0};
    std::array<glm::dmat4, 4> joint{};  ///< object_from_bind
    std::array<double, 4> weight{};
};

struct SkinnedVertex {
    glm::dvec3 position{0};
    glm::dvec3 normal{0, 1, 0};  ///< unit
};

/// The slow, obvious ways in double: the mean of matrices; and unit dual quaternions of eight
/// numbers each (Kavan et al. 2008, "Geometric Skinning with Approximate Dual Quaternion
/// Blending"), blended, divided by their length, turned into a matrix and applied. A joint's rigid
/// part is the motion that has its matrix's rotation and takes this vertex where the matrix does.
/// `opposite`: where a joint stands exactly half a turn from the strongest one, the other way
/// round.
[[nodiscard]] SkinnedVertex skin_linear(const SkinVertex& vertex);
[[nodiscard]] SkinnedVertex skin_dual(const SkinVertex& vertex, bool opposite = false);

/// Every vertex of a posed node, object space.
[[nodiscard]] std::vector<SkinnedVertex> skin_mesh(const MeshNode& node, bool opposite = false);

}  // namespace kino::test
