#pragma once

#include <deque>
#include <glm/vec3.hpp>
#include <optional>

#include "skeleton/gestures/gesture_definitions.h"

namespace kino {

/// Place and speed of a hand fitted as a line over the last smoothing_s: the same at every frame
/// rate of 15 and more.
struct HandSample {
    double time_s = 0;  ///< the middle of the window
    glm::dvec3 place{0}, speed_per_s{0};
};

/// What a hand did from rest to rest.
struct Stroke {
    HandSample from, to;
    double peak_speed_per_s = 0;
    glm::dvec3 low{0}, high{0};  ///< box of all places on the way
};

/// Fits the hand's motion and cuts it into strokes. Body space, arm lengths.
class HandMotion {
  public:
    /// Times must grow. Nothing until the window is filled.
    std::optional<HandSample> add(double time_s, const glm::dvec3& at, double smoothing_s);
    /// The stroke that ended with this sample: it stopped, or turned back.
    std::optional<Stroke> cut(const HandSample& sample, const StrokeDefinition& definition);
    void reset() { *this = {}; }

  private:
    struct Raw {
        double time_s;
        glm::dvec3 at;
    };
    std::deque<Raw> raw_;
    std::optional<HandSample> rest_;  // the last sample that was slow
    std::optional<Stroke> stroke_;
};

}  // namespace kino
