#include "tests/reference/lod_regions_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>

#include "tests/reference/lod_reference.h"

namespace kino::reference {
namespace {

/// Fine coordinate of a coarse one and back, along one axis.
struct Axis {
    double first, step;
    Axis(int fine, int coarse)
        : first(lod_place(0, fine, coarse)),
          step(coarse > 1 ? lod_place(1, fine, coarse) - first : 1) {}
    [[nodiscard]] double coarse_of(double x) const { return (x - first) / step; }
    [[nodiscard]] double fine_of(double j) const { return first + step * j; }
};

glm::dvec3 ray(double x, double y, const RegionRules& k) {
    return {(x - k.cx) / k.fx, (y - k.cy) / k.fy, 1};
}

/// Of a plane through `a` with its normal: how much ln z rises from it by one coarse texel.
double rise_of(const RegionCoarse& a, const glm::dvec3& at, const glm::dvec3& by) {
    // n . P is constant on the plane, n = (slope, -1): z = const / (n . ray).
    const double along = 1 - a.slope.x * at.x - a.slope.y * at.y;
    return (a.slope.x * by.x + a.slope.y * by.y) / std::max(along, 0.05);
}

}  // namespace

RegionFinding find_region(const Image<RegionCoarse>& coarse, const Image<RegionFine>& fine,
                          const glm::ivec2& tile, int side, const RegionRules& rules) {
    const Axis ax(fine.width(), coarse.width());
    const Axis ay(fine.height(), coarse.height());
    const int x_end = std::min((tile.x + 1) * side, fine.width());
    const int y_end = std::min((tile.y + 1) * side, fine.height());
    RegionFinding found;
    const auto joined = [&](int xa, int ya, int xb, int yb) {
        if (xb < 0 || yb < 0 || xb >= coarse.width() || yb >= coarse.height()) return false;
        const RegionCoarse& a = coarse.at(xa, ya);
        const RegionCoarse& b = coarse.at(xb, yb);
        if (!(a.z > 0 && b.z > 0)) return false;
        const glm::dvec3 at = ray(ax.fine_of(xa), ay.fine_of(ya), rules);
        const glm::dvec3 by((xb - xa) * ax.step / rules.fx, (yb - ya) * ay.step / rules.fy, 0);
        const double off = std::log(b.z / a.z) - rise_of(a, at, by);
        return std::abs(off) <= 2 * rules.sigma_z &&
               std::abs(a.slope.x - b.slope.x) <= 2 * rules.sigma_n &&
               std::abs(a.slope.y - b.slope.y) <= 2 * rules.sigma_n;
    };
    const auto root = [&](int x, int y) { return std::sqrt(coarse.at(x, y).luminance); };
    const auto clamped = [](double v, int count) {
        return std::clamp(static_cast<int>(std::floor(v)), 0, count - 1);
    };
    const int x0 = clamped(ax.coarse_of(tile.x * side), coarse.width());
    const int x1 = clamped(ax.coarse_of(x_end - 1) + 1, coarse.width());
    const int y0 = clamped(ay.coarse_of(tile.y * side), coarse.height());
    const int y1 = clamped(ay.coarse_of(y_end - 1), coarse.height());
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            for (const glm::ivec2 by : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
                if (!joined(x, y, x + by.x, y + by.y)) continue;
                const double own = std::sqrt(coarse.at(x, y).color);
                if (!rules.bend) {
                    const double other = std::sqrt(coarse.at(x + by.x, y + by.y).color);
                    const double step = std::abs(root(x, y) - root(x + by.x, y + by.y));
                    found.change = std::max(found.change, step * std::min(own, other));
                } else if (x >= by.x && y >= by.y && joined(x - by.x, y - by.y, x, y)) {
                    const double bend =
                        root(x - by.x, y - by.y) + root(x + by.x, y + by.y) - 2 * root(x, y);
                    found.change = std::max(found.change, 0.5 * std::abs(bend) * own);
                }
            }
        }
    }
    for (int y = tile.y * side; y < y_end; ++y) {
        for (int x = tile.x * side; x < x_end; ++x) {
            ++found.area;
            const RegionFine& i = fine.at(x, y);
            if (!(i.z > 0)) continue;
            double least = 1e9;
            const int jx = static_cast<int>(std::floor(ax.coarse_of(x)));
            const int jy = static_cast<int>(std::floor(ay.coarse_of(y)));
            for (int k = 0; k < 4; ++k) {
                const int cx = std::clamp(jx + (k & 1), 0, coarse.width() - 1);
                const int cy = std::clamp(jy + (k >> 1), 0, coarse.height() - 1);
                const RegionCoarse& j = coarse.at(cx, cy);
                if (!(j.z > 0)) continue;
                const glm::dvec3 pi = i.z * ray(x, y, rules);
                const glm::dvec3 pj = j.z * ray(ax.fine_of(cx), ay.fine_of(cy), rules);
                const double d = glm::dot(i.normal, pi - pj) / i.z / rules.sigma_z;
                const glm::dvec2 n = (i.slope - j.slope) / rules.sigma_n;
                least = std::min(least, 0.5 * (d * d + glm::dot(n, n)));
            }
            found.doubtful += least > -std::log(rules.confidence);
        }
    }
    return found;
}

}  // namespace kino::reference
