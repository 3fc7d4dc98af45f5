#pragma once

#include <span>

namespace kino {

/// Solves A x = b for symmetric A by L D L^T without pivoting. `a` has n rows of n numbers, of
/// which the lower triangle is read and overwritten; `b` becomes x. A pivot below 1e-12 of its
/// diagonal element pins its unknown to zero, so a singular system gives a finite answer.
void solve_symmetric(std::span<double> a, std::span<double> b, int n);

/// After solve_symmetric(): the diagonal element `i` of A^-1, from the factors it left in `a`.
[[nodiscard]] double inverse_diagonal(std::span<const double> a, int n, int i,
                                      std::span<double> scratch);

}  // namespace kino
