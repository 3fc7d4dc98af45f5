#include "calibration/live_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "calibration/projection.h"

namespace kino {
namespace {

constexpr std::size_t kMostPoints = 1200;
constexpr std::size_t kLeastPoints = 100;
constexpr std::size_t kLeastLooks = 3;
constexpr int kCoarse = 2;
constexpr int kClipLevels = 240;  // four times the grey levels a pixel: sums stay whole numbers
constexpr double kClearSharpness = 2.5;
constexpr double kSlidPx = 3;

int luma4(const Rgba8& p) {
    return p.r + 2 * p.g + p.b;
}

double middle_value(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double top_of(double before, double top, double after) {
    const double bend = before - 2 * top + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

}  // namespace

double LiveAlignment::Figure::off_px() const {
    return std::hypot(dx_px, dy_px);
}

void LiveAlignment::reset() {
    looks_.clear();
    frames_ = 0;
}

// Where pixels in front of a jump lie in the colour picture.
void LiveAlignment::find_places(const Image<float>& depth_m, const Image<RayXy>& rays,
                                const RigParameters& rig) {
    places_.clear();
    const Projection projection(*rig.color);
    struct Edge {
        int x, y;
    };
    std::vector<Edge> edges;
    for (int y = 1; y + 1 < depth_m.height(); y += 2) {
        const float* above = &depth_m.at(0, y - 1);
        const float* row = &depth_m.at(0, y);
        const float* below = &depth_m.at(0, y + 1);
        for (int x = 1; x + 1 < depth_m.width(); ++x) {
            const float z = row[x];
            const float farthest =
                std::max(std::max(row[x - 1], row[x + 1]), std::max(above[x], below[x]));
            // Cheapest question first: most pixels end here.
            if (!(farthest > 1.05f * z) || !(z > 0)) continue;
            if (farthest - z > 4 * Rig::quantisation_step_m(z)) edges.push_back({x, y});
        }
    }
    const double step =
        std::max(1.0, static_cast<double>(edges.size()) / static_cast<double>(kMostPoints));
    for (double at = 0; at < static_cast<double>(edges.size()); at += step) {
        const Edge& edge = edges[static_cast<std::size_t>(at)];
        const RayXy ray = rays.at(edge.x, edge.y);
        if (std::isnan(ray.x)) continue;
        const double z = depth_m.at(edge.x, edge.y);
        const auto px =
            projection.project(rig.color_from_depth * (z * glm::dvec3(ray.x, ray.y, 1)));
        if (!px) continue;
        const Place place{static_cast<int>(std::lround(px->x)),
                          static_cast<int>(std::lround(px->y))};
        constexpr int kMargin = kReachPx + 2;
        if (place.x < kMargin || place.y < kMargin || place.x >= rig.color->width - kMargin ||
            place.y >= rig.color->height - kMargin) {
            continue;
        }
        places_.push_back(place);
    }
}

double LiveAlignment::score(const Image<Rgba8>& color, int dx, int dy) const {
    std::int64_t sum = 0;
    for (const Place& place : places_) {
        const Rgba8* p = &color.at(place.x + dx, place.y + dy);
        const std::ptrdiff_t row = color.width();
        const int gx = luma4(p[1]) - luma4(p[-1]);
        const int gy = luma4(p[row]) - luma4(p[-row]);
        sum += std::min(kClipLevels, std::max(std::abs(gx), std::abs(gy)));
    }
    return static_cast<double>(sum) / static_cast<double>(places_.size());
}

std::optional<LiveAlignment::Figure> LiveAlignment::look_now(const Image<float>& depth_m,
                                                             const Image<RayXy>& rays,
                                                             const Image<Rgba8>& color,
                                                             const RigParameters& rig) {
    if (!rig.color || color.width() != rig.color->width || color.height() != rig.color->height ||
        depth_m.width() != rays.width() || depth_m.height() != rays.height()) {
        return std::nullopt;
    }
    const auto began = std::chrono::steady_clock::now();
    find_places(depth_m, rays, rig);
    if (places_.size() < kLeastPoints) return std::nullopt;
    int bx = 0;
    int by = 0;
    double best = -1;
    double mean = 0;
    double square = 0;
    double count = 0;
    for (int dy = -kReachPx; dy <= kReachPx; dy += kCoarse) {
        for (int dx = -kReachPx; dx <= kReachPx; dx += kCoarse) {
            const double s = score(color, dx, dy);
            mean += s;
            square += s * s;
            ++count;
            if (s <= best) continue;
            best = s;
            bx = dx;
            by = dy;
        }
    }
    const int cx = bx;
    const int cy = by;
    std::array<std::array<double, 5>, 5> near{};
    for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
            const bool inside =
                std::abs(cx + dx) <= kReachPx + 1 && std::abs(cy + dy) <= kReachPx + 1;
            const double s = inside ? score(color, cx + dx, cy + dy) : -1;
            near[static_cast<std::size_t>(dy + 2)][static_cast<std::size_t>(dx + 2)] = s;
            if (std::abs(dx) > 1 || std::abs(dy) > 1 || s <= best) continue;
            best = s;
            bx = cx + dx;
            by = cy + dy;
        }
    }
    const auto at = [&](int dx, int dy) {
        return near[static_cast<std::size_t>(by - cy + dy + 2)]
                   [static_cast<std::size_t>(bx - cx + dx + 2)];
    };
    mean /= count;
    const double deviation = std::sqrt(std::max(0.0, square / count - mean * mean));
    Figure out;
    out.dx_px = bx + top_of(at(-1, 0), best, at(1, 0));
    out.dy_px = by + top_of(at(0, -1), best, at(0, 1));
    out.sharpness = deviation > 0 ? (best - mean) / deviation : 0;
    out.looks = 1;
    out.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
    return out;
}

void LiveAlignment::look(const Image<float>& depth_m, const Image<RayXy>& rays,
                         const Image<Rgba8>& color, const RigParameters& rig) {
    if (frames_++ % kEvery != 0) return;
    const auto found = look_now(depth_m, rays, color, rig);
    if (!found || found->sharpness < kClearSharpness) return;
    looks_.push_back(*found);
    if (looks_.size() > kLooks) looks_.erase(looks_.begin());
}

std::optional<LiveAlignment::Figure> LiveAlignment::figure() const {
    if (looks_.size() < kLeastLooks) return std::nullopt;
    std::vector<double> dx;
    std::vector<double> dy;
    for (const Figure& one : looks_) {
        dx.push_back(one.dx_px);
        dy.push_back(one.dy_px);
    }
    Figure out = looks_.back();
    out.dx_px = middle_value(std::move(dx));
    out.dy_px = middle_value(std::move(dy));
    out.looks = static_cast<int>(looks_.size());
    return out;
}

std::string LiveAlignment::words() const {
    const auto now = figure();
    if (!now) return {};
    return fmt::format("colour {:.1f} px from depth: {}", now->off_px(),
                       now->off_px() <= kSlidPx ? "good" : "it has slid, calibrate again");
}

}  // namespace kino
