#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/image.h"
#include "tests/reference/depth_filters.h"

namespace kino {

// A lost pixel counts as this far off, and nothing counts as more.
constexpr double kWorstMm = 100;
constexpr int kEdgePx = 3;
constexpr double kStepPerM = 0.00307;

struct Shot {
    Image<float> depth_m;  // what the filters get
    Image<float> truth_m;
    Image<std::uint8_t> expected;  // 1 where the sensor can see
};

/// Whether two true depths are two surfaces: T(z) of the depth mesh, with the slope of 80 degrees.
inline bool is_step(float a, float b) {
    const double limit = 3 * kStepPerM + 5.67 / (571.0 * std::max(a, b));
    return std::abs(1 / double{a} - 1 / double{b}) > limit;
}

/// The truth of a decimated picture: each block's true surface.
struct Goal {
    Image<double> truth_m;
    Image<std::uint8_t> expected, near_edge;
};

inline Goal goal_of(const Shot& shot, int factor) {
    Goal goal;
    goal.truth_m = reference::decimate(shot.truth_m, factor, 3, 1);
    const int w = goal.truth_m.width();
    const int h = goal.truth_m.height();
    goal.expected = Image<std::uint8_t>(w, h, 0);
    goal.near_edge = Image<std::uint8_t>(w, h, 0);
    for (int y = 0; y < shot.expected.height(); ++y) {
        for (int x = 0; x < shot.expected.width(); ++x) {
            goal.expected.at(x / factor, y / factor) |= shot.expected.at(x, y);
        }
    }
    const auto mark = [&](int cx, int cy) {
        for (int y = std::max(0, cy - kEdgePx); y <= std::min(h - 1, cy + kEdgePx); ++y) {
            for (int x = std::max(0, cx - kEdgePx); x <= std::min(w - 1, cx + kEdgePx); ++x) {
                goal.near_edge.at(x, y) = 1;
            }
        }
    };
    for (int y = 1; y < h; ++y) {
        for (int x = 1; x < w; ++x) {
            const auto here = static_cast<float>(goal.truth_m.at(x, y));
            if (is_step(here, static_cast<float>(goal.truth_m.at(x - 1, y))) ||
                is_step(here, static_cast<float>(goal.truth_m.at(x, y - 1)))) {
                mark(x, y);
            }
        }
    }
    return goal;
}

struct Sum {
    double squares = 0;
    double count = 0;
    void add(double mm) {
        squares += mm * mm;
        count += 1;
    }
    [[nodiscard]] double rms() const { return count > 0 ? std::sqrt(squares / count) : 0; }
};

struct Score {
    Sum all, surface, edge, filled;
    double flying = 0, lost = 0, frames = 0;
};

template <class Pixel>
bool hangs_in_the_air(const Image<Pixel>& out, const Goal& goal, int x, int y) {
    const auto z = static_cast<float>(out.at(x, y));
    for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) {
            if (!goal.truth_m.contains(u, v)) continue;
            if (!is_step(z, static_cast<float>(goal.truth_m.at(u, v)))) return false;
        }
    }
    return true;
}

template <class Pixel>
void judge(const Image<Pixel>& out, const Goal& goal, const Image<float>& in, Score& score) {
    const bool same_size = in.width() == out.width();
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            const double z = out.at(x, y);
            const double mm =
                z > 0 ? std::min(kWorstMm, 1000 * std::abs(z - goal.truth_m.at(x, y))) : kWorstMm;
            if (z > 0 && hangs_in_the_air(out, goal, x, y)) score.flying += 1;
            if (same_size && z > 0 && !(in.at(x, y) > 0)) score.filled.add(mm);
            if (goal.expected.at(x, y) == 0) continue;
            score.all.add(mm);
            if (z == 0) score.lost += 1;
            if (goal.near_edge.at(x, y) != 0) {
                score.edge.add(mm);
            } else if (z > 0) {
                score.surface.add(mm);
            }
        }
    }
    score.frames += 1;
}

}  // namespace kino
