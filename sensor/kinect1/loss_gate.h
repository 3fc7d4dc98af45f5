#pragma once

#include <mutex>
#include <string>
#include <utility>

#include "sensor/live/device.h"

namespace kino::kinect1 {

/// Between a device's threads and its intakes: a loss is said once, and nothing is put after it,
/// whichever of the streams notices first. Thread-safe.
class LossGate {
  public:
    void put(FrameIntake& intake, StreamId id, StreamFrame frame) {
        const std::lock_guard lock(mutex_);
        if (!lost_) intake.put(id, std::move(frame));
    }
    void lose(FrameIntake& intake, std::string why) {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(lost_, true)) intake.lost(std::move(why));
    }
    [[nodiscard]] bool lost() const {
        const std::lock_guard lock(mutex_);
        return lost_;
    }

  private:
    mutable std::mutex mutex_;
    bool lost_ = false;
};

}  // namespace kino::kinect1
