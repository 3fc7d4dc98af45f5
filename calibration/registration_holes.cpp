#include "calibration/registration_holes.h"

#include <algorithm>
#include <cmath>

#include "calibration/rig.h"

namespace kino::registration {
namespace {

constexpr int kAround[8][2] = {{-1, 0},  {1, 0},  {0, -1}, {0, 1},
                               {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

// Least squares of 1/z = c + a x + b y, x and y from the first pixel.
struct PlaneFit {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, w = 0, xw = 0, yw = 0;

    void add(double px, double py, double pw) {
        n += 1, x += px, y += py, xx += px * px, xy += px * py, yy += py * py;
        w += pw, xw += px * pw, yw += py * pw;
    }
    // False where the pixels lie on a line.
    bool solve(double& a, double& b, double& c) const {
        const double sxx = xx - x * x / n;
        const double sxy = xy - x * y / n;
        const double syy = yy - y * y / n;
        const double det = sxx * syy - sxy * sxy;
        if (!(det > 1e-6)) return false;
        const double sxw = xw - x * w / n;
        const double syw = yw - y * w / n;
        a = (syy * sxw - sxy * syw) / det;
        b = (sxx * syw - sxy * sxw) / det;
        c = (w - a * x - b * y) / n;
        return true;
    }
};

}  // namespace

bool HoleFiller::collect(const Image<float>& depth_m, Pixel first, int largest_px) {
    hole_.clear();
    hole_.push_back(first);
    seen_.at(first.x, first.y) = 1;
    bool enclosed = true;
    // Also where it is too large already: all of it has been looked at then, once.
    for (std::size_t i = 0; i < hole_.size(); ++i) {
        const Pixel p = hole_[i];
        for (int k = 0; k < 4; ++k) {
            const Pixel q{p.x + kAround[k][0], p.y + kAround[k][1]};
            if (!depth_m.contains(q.x, q.y)) {
                enclosed = false;
            } else if (depth_m.at(q.x, q.y) == 0 && seen_.at(q.x, q.y) == 0) {
                seen_.at(q.x, q.y) = 1;
                hole_.push_back(q);
            }
        }
    }
    return enclosed && hole_.size() <= static_cast<std::size_t>(largest_px);
}

void HoleFiller::close(Image<float>& depth_m) const {
    const Pixel origin = hole_.front();
    const auto for_rim = [&](auto&& use) {
        for (const Pixel p : hole_) {
            for (const auto& [dx, dy] : kAround) {
                // Enclosed by sides, it may still touch the border with a corner.
                if (!depth_m.contains(p.x + dx, p.y + dy)) continue;
                const float z = depth_m.at(p.x + dx, p.y + dy);
                if (z > 0) use(p.x + dx - origin.x, p.y + dy - origin.y, 1.0 / z);
            }
        }
    };
    PlaneFit fit;
    for_rim([&](int x, int y, double w) { fit.add(x, y, w); });
    double a = 0, b = 0, c = 0;
    if (!fit.solve(a, b, c)) return;
    const double three_steps = 3 * Rig::quantisation_step_m(1.0f);
    bool flat = true;
    for_rim([&](int x, int y, double w) {
        flat = flat && std::abs(c + a * x + b * y - w) <= three_steps;
    });
    if (!flat) return;
    for (const Pixel p : hole_) {
        const double w = c + a * (p.x - origin.x) + b * (p.y - origin.y);
        if (w > 0) depth_m.at(p.x, p.y) = static_cast<float>(1 / w);
    }
}

void HoleFiller::fill(Image<float>& depth_m, int largest_px) {
    seen_.resize(depth_m.width(), depth_m.height());
    seen_.fill(0);
    hole_.reserve(depth_m.size());
    // Filled pixels are not looked at again: seen_ holds them, and their depth is not 0.
    for (int y = 1; y + 1 < depth_m.height(); ++y) {
        for (int x = 1; x + 1 < depth_m.width(); ++x) {
            if (depth_m.at(x, y) != 0 || seen_.at(x, y) != 0) continue;
            if (collect(depth_m, {x, y}, largest_px)) close(depth_m);
        }
    }
}

}  // namespace kino::registration
