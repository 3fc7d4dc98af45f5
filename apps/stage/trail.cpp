#include "apps/stage/trail.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace kino {

void Trail::lay(TrailPoint point) {
    point.number = laid_++;
    if (points_.size() < capacity_) {
        // What was forgotten left the ring in order.
        points_.push_back(point);
        return;
    }
    points_[first_] = point;
    first_ = (first_ + 1) % capacity_;
}

void Trail::reach(const glm::dvec3& world_m, double now_s) {
    const double step = glm::distance(world_m, last_m_);
    if (!drawing_ || !(step <= kLongestStrokeM)) {
        drawing_ = true;
        last_m_ = world_m;
        lay({.world_m = world_m, .born_s = now_s, .way_m = way_m_});
        return;
    }
    const glm::dvec3 from = last_m_;
    for (double at = spacing_m_; at <= step; at += spacing_m_) {
        way_m_ += spacing_m_;
        last_m_ = from + (world_m - from) * (at / step);
        lay({.world_m = last_m_, .born_s = now_s, .way_m = way_m_, .joined = true});
    }
}

void Trail::forget_before(double born_s) {
    std::size_t old = 0;
    while (old < points_.size() && newest(points_.size() - 1 - old).born_s < born_s) ++old;
    if (old == 0) return;
    // Brought into order first: points are added at the end while there is room.
    std::rotate(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(first_),
                points_.end());
    first_ = 0;
    points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(old));
}

void Trail::clear() {
    points_.clear();
    first_ = 0;
    drawing_ = false;
    way_m_ = 0;
}

const TrailPoint& Trail::newest(std::size_t i) const {
    KINO_CHECK(i < points_.size());
    return points_[(first_ + points_.size() - 1 - i) % points_.size()];
}

}  // namespace kino
