#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace kino {

/// The rotation nearest to `m` (largest trace of its transpose times m; the rotation of the polar
/// decomposition where the determinant is positive): the eigenvector of the largest eigenvalue of a
/// symmetric 4 x 4 matrix (Horn 1987), by Jacobi's method. Of unit length within 1e-12, and the
/// same bits for the same matrix; no rotation for a matrix that says nothing of one.
[[nodiscard]] glm::dquat nearest_rotation(const glm::dmat3& m);

}  // namespace kino
