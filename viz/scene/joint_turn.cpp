#include "viz/scene/joint_turn.h"

#include <array>
#include <cmath>

namespace kino {

glm::dquat nearest_rotation(const glm::dmat3& m) {
    const auto e = [&](int row, int column) { return m[column][row]; };
    std::array<std::array<double, 4>, 4> k = {
        {{e(0, 0) + e(1, 1) + e(2, 2), e(2, 1) - e(1, 2), e(0, 2) - e(2, 0), e(1, 0) - e(0, 1)},
         {0, e(0, 0) - e(1, 1) - e(2, 2), e(0, 1) + e(1, 0), e(0, 2) + e(2, 0)},
         {0, 0, -e(0, 0) + e(1, 1) - e(2, 2), e(1, 2) + e(2, 1)},
         {0, 0, 0, -e(0, 0) - e(1, 1) + e(2, 2)}}};
    double size = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            if (j < i) k[i][j] = k[j][i];
            size = std::max(size, std::abs(k[i][j]));
        }
    }
    if (!(size > 0) || !std::isfinite(size)) return {1, 0, 0, 0};
    std::array<std::array<double, 4>, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i][i] = 1;
    for (int sweep = 0; sweep < 16; ++sweep) {
        double off = 0;
        for (std::size_t p = 0; p < 4; ++p) {
            for (std::size_t q = p + 1; q < 4; ++q) off = std::max(off, std::abs(k[p][q]));
        }
        if (off <= 1e-15 * size) break;
        for (std::size_t p = 0; p < 4; ++p) {
            for (std::size_t q = p + 1; q < 4; ++q) {
                if (std::abs(k[p][q]) <= 1e-18 * size) continue;
                // The rotation of the plane p, q that makes k[p][q] zero.
                const double theta = (k[q][q] - k[p][p]) / (2 * k[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1.0));
                const double c = 1 / std::hypot(t, 1.0);
                const double s = t * c;
                for (std::size_t i = 0; i < 4; ++i) {
                    const double a = k[i][p];
                    const double b = k[i][q];
                    k[i][p] = c * a - s * b;
                    k[i][q] = s * a + c * b;
                }
                for (std::size_t i = 0; i < 4; ++i) {
                    const double a = k[p][i];
                    const double b = k[q][i];
                    k[p][i] = c * a - s * b;
                    k[q][i] = s * a + c * b;
                    const double x = v[i][p];
                    const double y = v[i][q];
                    v[i][p] = c * x - s * y;
                    v[i][q] = s * x + c * y;
                }
            }
        }
    }
    std::size_t best = 0;
    for (std::size_t i = 1; i < 4; ++i) {
        if (k[i][i] > k[best][best]) best = i;
    }
    const glm::dquat q(v[0][best], v[1][best], v[2][best], v[3][best]);
    return q * ((q.w < 0 ? -1 : 1) / glm::length(q));
}

}  // namespace kino
