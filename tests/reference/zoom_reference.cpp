#include "tests/reference/zoom_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kino::reference {
namespace {

double clamped(const Image<std::uint32_t>& small, int c, int x, int y) {
    return channel(
        small.at(std::clamp(x, 0, small.width() - 1), std::clamp(y, 0, small.height() - 1)), c);
}

int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Weight of the pixel k away after some passes of the box.
double box_weight(int z, int passes, int k) {
    if (passes == 0) return k == 0 ? 1 : 0;
    double sum = 0;
    const int reach = z / 2;
    for (int b = -reach; b <= reach; ++b) {
        const double share = z % 2 == 0 && std::abs(b) == reach ? 0.5 / z : 1.0 / z;
        sum += share * box_weight(z, passes - 1, k - b);
    }
    return sum;
}

}  // namespace

double channel(std::uint32_t pixel, int channel) {
    return (pixel >> (8 * channel)) & 255u;
}

double zoom_bilinear(const Image<std::uint32_t>& small, int z, int c, int x, int y) {
    const double u = (x + 0.5) / z - 0.5;
    const double v = (y + 0.5) / z - 0.5;
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const double a = u - i;
    const double b = v - j;
    return (1 - b) * ((1 - a) * clamped(small, c, i, j) + a * clamped(small, c, i + 1, j)) +
           b * ((1 - a) * clamped(small, c, i, j + 1) + a * clamped(small, c, i + 1, j + 1));
}

double zoom_boxes(const Image<std::uint32_t>& small, int z, int passes, int c, int x, int y) {
    const int reach = passes * (z / 2);
    double sum = 0;
    for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
            sum += box_weight(z, passes, dx) * box_weight(z, passes, dy) *
                   clamped(small, c, floor_div(x + dx, z), floor_div(y + dy, z));
        }
    }
    return sum;
}

}  // namespace kino::reference
