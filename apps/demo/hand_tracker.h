#pragma once

#include <array>
#include <cstddef>

#include "skeleton/gestures/body_space.h"

namespace kino::demo {

/// How far into each gesture somebody is, by rough measures of its own: 0 .. 1. What decides is
/// the recogniser; this only tells the person that something is seen.
class HandTracker {
  public:
    void reset() { *this = {}; }
    /// `body` null: not there. Time by any clock that does not go back.
    void step(double time_s, double dt_s, const Body* body);

    [[nodiscard]] double waved() const;
    [[nodiscard]] double swiped() const;
    [[nodiscard]] double pushed() const;
    [[nodiscard]] double both_in_zone() const;
    [[nodiscard]] double raised() const;
    /// 0 left, 1 right: the hand that is higher.
    [[nodiscard]] std::size_t busier() const;

  private:
    struct Side {
        bool seen = false;
        glm::dvec3 at{0}, slow{0};  ///< now, and followed slowly: where it comes from
        double turn_x = 0;          ///< the last extreme of a swing
        int way = 0;
        std::array<double, 4> turned_s{-1e9, -1e9, -1e9, -1e9};  ///< the last reversals
        std::size_t next = 0;
        bool up = false, in_zone = false, raised = false;
    };

    BodySpace space_;
    std::array<Side, 2> sides_;
    double time_s_ = 0;
    double raised_s_ = 0;
};

}  // namespace kino::demo
