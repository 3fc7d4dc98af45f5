#include "calibration/solve/mutual_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr int kClasses = 16;
constexpr std::size_t kLeastPixels = 2000;
constexpr std::size_t kMostPixels = 20000;

struct MutualPoint {
    int x, y;
    int depth_class;
};

double entropy_term(double share) {
    return share > 0 ? -share * std::log2(share) : 0;
}

// Top of the parabola through three values around the highest.
double parabola_top(double before, double top, double after) {
    const double bend = before - 2 * top + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

// Limits between equally frequent classes.
std::array<std::uint8_t, 256> grey_classes(const Image<std::uint8_t>& grey) {
    std::array<std::size_t, 256> counts{};
    for (const std::uint8_t value : grey.pixels()) ++counts[value];
    std::array<std::uint8_t, 256> out{};
    std::size_t below = 0;
    for (std::size_t value = 0; value < 256; ++value) {
        const std::size_t middle = below + counts[value] / 2;
        out[value] = static_cast<std::uint8_t>(std::min<std::size_t>(
            kClasses - 1, middle * kClasses / std::max<std::size_t>(1, grey.size())));
        below += counts[value];
    }
    return out;
}

std::vector<MutualPoint> mutual_points(const Image<float>& depth_m, const Image<ColorUv>& uv) {
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        if (depth_m.pixels()[i] > 0 && uv.pixels()[i].valid()) seen.push_back(i);
    }
    std::vector<MutualPoint> out;
    if (seen.size() < kLeastPixels) return out;
    std::vector<float> sorted;
    for (const std::size_t i : seen) sorted.push_back(depth_m.pixels()[i]);
    std::sort(sorted.begin(), sorted.end());
    std::array<float, kClasses - 1> limits{};
    for (std::size_t c = 0; c < limits.size(); ++c) {
        limits[c] = sorted[(c + 1) * sorted.size() / kClasses];
    }
    const double step = std::max(1.0, static_cast<double>(seen.size()) / kMostPixels);
    const int half = 1 << (kUvFractionBits - 1);
    for (double at = 0; at < static_cast<double>(seen.size()); at += step) {
        const std::size_t i = seen[static_cast<std::size_t>(at)];
        const ColorUv place = uv.pixels()[i];
        const auto depth_class =
            std::upper_bound(limits.begin(), limits.end(), depth_m.pixels()[i]) - limits.begin();
        out.push_back({(place.u + half) >> kUvFractionBits, (place.v + half) >> kUvFractionBits,
                       static_cast<int>(depth_class)});
    }
    return out;
}

double bits_at(const std::vector<MutualPoint>& points, const Image<std::uint8_t>& classes, int dx,
               int dy) {
    std::array<int, kClasses * kClasses> joint{};
    int count = 0;
    for (const MutualPoint& p : points) {
        if (!classes.contains(p.x + dx, p.y + dy)) continue;
        ++joint[static_cast<std::size_t>(p.depth_class * kClasses +
                                         classes.at(p.x + dx, p.y + dy))];
        ++count;
    }
    if (count == 0) return 0;
    std::array<int, kClasses> by_depth{};
    std::array<int, kClasses> by_grey{};
    double bits = 0;
    for (std::size_t i = 0; i < joint.size(); ++i) {
        by_depth[i / kClasses] += joint[i];
        by_grey[i % kClasses] += joint[i];
        bits -= entropy_term(static_cast<double>(joint[i]) / count);
    }
    for (std::size_t i = 0; i < kClasses; ++i) {
        bits += entropy_term(static_cast<double>(by_depth[i]) / count) +
                entropy_term(static_cast<double>(by_grey[i]) / count);
    }
    return bits;
}

}  // namespace

std::optional<MutualAlignment> mutual_alignment(const Image<float>& depth_m,
                                                const Image<ColorUv>& uv,
                                                const Image<std::uint8_t>& grey, int reach) {
    KINO_CHECK_EQ(depth_m.width(), uv.width());
    KINO_CHECK_EQ(depth_m.height(), uv.height());
    KINO_CHECK(reach > 0);
    const std::vector<MutualPoint> points = mutual_points(depth_m, uv);
    if (points.empty()) return std::nullopt;
    const auto class_of = grey_classes(grey);
    Image<std::uint8_t> classes(grey.width(), grey.height());
    for (std::size_t i = 0; i < grey.size(); ++i) {
        classes.pixels()[i] = class_of[grey.pixels()[i]];
    }
    const int side = 2 * reach + 1;
    std::vector<double> scores;
    for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) scores.push_back(bits_at(points, classes, dx, dy));
    }
    const auto score = [&](int dx, int dy) {
        return scores[static_cast<std::size_t>((dy + reach) * side + dx + reach)];
    };
    const auto top = std::max_element(scores.begin(), scores.end()) - scores.begin();
    const int bx = static_cast<int>(top) % side - reach;
    const int by = static_cast<int>(top) / side - reach;
    double mean = 0;
    double square = 0;
    for (const double s : scores) {
        mean += s / static_cast<double>(scores.size());
        square += s * s / static_cast<double>(scores.size());
    }
    const double deviation = std::sqrt(std::max(0.0, square - mean * mean));
    if (!(score(bx, by) > 1e-9)) return std::nullopt;
    MutualAlignment out;
    out.points = static_cast<int>(points.size());
    out.bits = score(0, 0);
    out.best_bits = score(bx, by);
    out.sharpness = deviation > 0 ? (out.best_bits - mean) / deviation : 0;
    out.dx_px = bx;
    out.dy_px = by;
    if (std::abs(bx) < reach)
        out.dx_px += parabola_top(score(bx - 1, by), score(bx, by), score(bx + 1, by));
    if (std::abs(by) < reach)
        out.dy_px += parabola_top(score(bx, by - 1), score(bx, by), score(bx, by + 1));
    return out;
}

}  // namespace kino
