#pragma once

#include <cstdint>

#include "base/time.h"
#include "skeleton/gestures/gesture_definitions.h"

namespace kino {

/// Who is in control. Nobody, until somebody waves. After that nobody else can take over while the
/// primary user is there: only once they are out of view for lost_s, further than max_distance_m
/// away for leave_s, or have waved again themselves, which offers the lock for offer_s to the next
/// who waves.
class PrimaryUser {
  public:
    [[nodiscard]] std::uint32_t id() const { return id_; }  ///< 0: nobody

    /// Once a frame before any waves; true if the lock was released by it. `seen`: the primary user
    /// is in the frame with a trunk, distance_m from the sensor.
    bool update(TimeNs time, bool seen, double distance_m, const PrimaryDefinition& d);
    /// True if the lock went to `id` by this wave.
    bool wave(std::uint32_t id, TimeNs time, double distance_m, const PrimaryDefinition& d);
    /// Hands the lock to a body, or to nobody with 0: for a program's own button.
    void hand_over(std::uint32_t id, TimeNs time);

  private:
    std::uint32_t id_ = 0;
    TimeNs seen_ = 0, near_ = 0, offer_until_ = 0;
};

}  // namespace kino
