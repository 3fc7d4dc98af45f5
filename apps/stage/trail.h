#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace kino {

struct TrailPoint {
    glm::dvec3 world_m{0};
    double born_s = 0;
    double way_m = 0;          ///< from the trail's beginning
    bool joined = false;       ///< the stroke goes on from the point before
    std::uint64_t number = 0;  ///< of all that were laid
};

/// The points that something moving leaves behind, evenly along its way: the newest `capacity`.
class Trail {
  public:
    /// Farther in one step than this is no stroke but a jump.
    static constexpr double kLongestStrokeM = 0.6;

    Trail(std::size_t capacity, double spacing_m) : capacity_(capacity), spacing_m_(spacing_m) {
        points_.reserve(capacity);
    }

    /// It is at `world_m` now. Points are laid on the straight line from where it was; they are
    /// all born now.
    void reach(const glm::dvec3& world_m, double now_s);
    /// It is lost: the next point begins a new stroke.
    void lift() { drawing_ = false; }
    /// Forgets points older than this.
    void forget_before(double born_s);
    void clear();

    [[nodiscard]] std::size_t size() const { return points_.size(); }
    [[nodiscard]] std::size_t capacity() const { return capacity_; }
    /// 0 is the newest.
    [[nodiscard]] const TrailPoint& newest(std::size_t i) const;

  private:
    void lay(TrailPoint point);

    std::size_t capacity_;
    double spacing_m_;
    std::vector<TrailPoint> points_;  // a ring once it is full; the oldest at first_
    std::size_t first_ = 0;
    bool drawing_ = false;
    glm::dvec3 last_m_{0};  // where the last point was laid
    double way_m_ = 0;
    std::uint64_t laid_ = 0;
};

}  // namespace kino
