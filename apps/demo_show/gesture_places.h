#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "base/body.h"
#include "base/pose.h"
#include "skeleton/gestures/gesture_event.h"

namespace kino {

/// Where the hands are that made the last gestures, so that the answer is given there.
class GesturePlaces {
  public:
    void reset() { last_ = {}; }
    void hear(const GestureEvent& event);
    /// World; of the hand that made the last gesture of this kind, or between both hands. `mirror`:
    /// the stage shows bodies turned over in the depth camera's plane x = 0. Empty where nobody
    /// made it, or the hand is not known now.
    [[nodiscard]] std::optional<glm::dvec3> of(GestureKind kind, const BodyFrame* bodies,
                                               const Pose& world_from_depth, bool mirror) const;

  private:
    struct Made {
        std::uint32_t body_id = 0;  ///< 0: nobody yet
        Hand hand = Hand::none;
    };
    std::array<Made, kGestureKindCount> last_{};
};

}  // namespace kino
