#include "skeleton/tracking/small_solver.h"

#include <cstddef>

namespace kino {

void solve_symmetric(std::span<double> a, std::span<double> b, int n) {
    const auto size = static_cast<std::size_t>(n);
    // Row i of the lower triangle becomes L(i, :) with 1/D(i) on the diagonal.
    for (std::size_t i = 0; i < size; ++i) {
        double* row = a.data() + i * size;
        const double diagonal = row[i];
        double rest = diagonal;
        for (std::size_t j = 0; j < i; ++j) {
            const double* other = a.data() + j * size;
            double sum = row[j];
            for (std::size_t k = 0; k < j; ++k) sum -= row[k] * other[k];
            row[j] = sum;  // L D, until the row is complete
        }
        for (std::size_t j = 0; j < i; ++j) {
            const double scaled = row[j] * a[j * size + j];
            rest -= row[j] * scaled;
            row[j] = scaled;
        }
        row[i] = rest > 1e-12 * diagonal && rest > 0 ? 1 / rest : 0;
    }
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t k = 0; k < i; ++k) b[i] -= a[i * size + k] * b[k];
    }
    for (std::size_t i = 0; i < size; ++i) b[i] *= a[i * size + i];
    for (std::size_t i = size; i-- > 0;) {
        for (std::size_t k = 0; k < i; ++k) b[k] -= a[i * size + k] * b[i];
    }
}

double inverse_diagonal(std::span<const double> a, int n, int i, std::span<double> scratch) {
    const auto size = static_cast<std::size_t>(n), first = static_cast<std::size_t>(i);
    double sum = 0;
    for (std::size_t r = first; r < size; ++r) {
        double y = r == first ? 1.0 : 0.0;
        for (std::size_t k = first; k < r; ++k) y -= a[r * size + k] * scratch[k];
        scratch[r] = y;
        sum += y * y * a[r * size + r];
    }
    return sum;
}

}  // namespace kino
