#include "calibration/solve/edge_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr float kJumpShare = 0.05f;
constexpr float kJumpSteps = 4;
constexpr std::size_t kLeastPoints = 200;
constexpr double kClip = 60;  // grey levels a pixel, either axis

std::vector<glm::ivec2> contour(const Image<float>& depth_m, const Image<ColorUv>& uv) {
    std::vector<glm::ivec2> out;
    constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (int y = 1; y + 1 < depth_m.height(); ++y) {
        for (int x = 1; x + 1 < depth_m.width(); ++x) {
            const float z = depth_m.at(x, y);
            const ColorUv place = uv.at(x, y);
            if (!(z > 0) || !place.valid()) continue;
            const float jump = std::max(kJumpShare * z, kJumpSteps * Rig::quantisation_step_m(z));
            const bool edge = std::any_of(kSteps.begin(), kSteps.end(), [&](const auto& step) {
                const float other = depth_m.at(x + step[0], y + step[1]);
                return other > z + jump;
            });
            const int half = 1 << (kUvFractionBits - 1);
            if (edge) {
                out.emplace_back((place.u + half) >> kUvFractionBits,
                                 (place.v + half) >> kUvFractionBits);
            }
        }
    }
    return out;
}

Image<float> gradient(const Image<std::uint8_t>& grey) {
    Image<float> out(grey.width(), grey.height(), 0);
    for (int y = 1; y + 1 < grey.height(); ++y) {
        for (int x = 1; x + 1 < grey.width(); ++x) {
            const double gx = (grey.at(x + 1, y) - grey.at(x - 1, y)) / 2.0;
            const double gy = (grey.at(x, y + 1) - grey.at(x, y - 1)) / 2.0;
            out.at(x, y) = static_cast<float>(std::min(kClip, std::hypot(gx, gy)));
        }
    }
    return out;
}

// Top of the parabola through three values around the highest.
double refine(double before, double top, double after) {
    const double bend = before - 2 * top + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

}  // namespace

std::optional<EdgeAlignment> edge_alignment(const Image<float>& depth_m, const Image<ColorUv>& uv,
                                            const Image<std::uint8_t>& grey, int reach) {
    KINO_CHECK_EQ(depth_m.width(), uv.width());
    KINO_CHECK_EQ(depth_m.height(), uv.height());
    KINO_CHECK_LE(1, reach);
    const auto points = contour(depth_m, uv);
    if (points.size() < kLeastPoints) return std::nullopt;
    const Image<float> strength = gradient(grey);
    const int side = 2 * reach + 1;
    std::vector<double> scores(static_cast<std::size_t>(side * side));
    const auto score = [&](int dx, int dy) -> double& {
        return scores[static_cast<std::size_t>((dy + reach) * side + dx + reach)];
    };
    for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
            double sum = 0;
            for (const glm::ivec2& p : points) {
                if (strength.contains(p.x + dx, p.y + dy)) sum += strength.at(p.x + dx, p.y + dy);
            }
            score(dx, dy) = sum / static_cast<double>(points.size());
        }
    }
    const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
    const int bx = static_cast<int>(best % side) - reach;
    const int by = static_cast<int>(best / side) - reach;
    double mean = 0;
    double square = 0;
    for (const double s : scores) {
        mean += s;
        square += s * s;
    }
    const auto count = static_cast<double>(scores.size());
    mean /= count;
    const double deviation = std::sqrt(std::max(0.0, square / count - mean * mean));
    EdgeAlignment out;
    out.contour_points = static_cast<int>(points.size());
    out.sharpness = deviation > 0 ? (score(bx, by) - mean) / deviation : 0;
    out.dx_px = bx;
    out.dy_px = by;
    if (std::abs(bx) < reach)
        out.dx_px += refine(score(bx - 1, by), score(bx, by), score(bx + 1, by));
    if (std::abs(by) < reach)
        out.dy_px += refine(score(bx, by - 1), score(bx, by), score(bx, by + 1));
    return out;
}

}  // namespace kino
