#pragma once

#include <chrono>

#include "base/time.h"

namespace kino {

/// Host time from stage to stage.
class StageClock {
  public:
    /// Since the last lap, or the beginning, ns.
    TimeNs lap() {
        const auto now = std::chrono::steady_clock::now();
        const TimeNs passed =
            std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
        last_ = now;
        return passed;
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace kino
