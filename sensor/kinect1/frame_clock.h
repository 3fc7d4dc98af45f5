#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>

#include "sensor/kinect1/camera_mode.h"
#include "sensor/live/device_clock.h"

namespace kino::kinect1 {

/// Device times of the camera's two endpoints. Both are stamped by one 60 MHz counter, as OpenNI's
/// frame synchronisation relies on; a unit whose endpoints disagree by more than a quarter of a
/// second against the host's clock gets a clock for each. Thread-safe.
class FrameClock {
  public:
    /// `endpoint` 0 or 1. Times of one endpoint rise strictly.
    [[nodiscard]] DeviceClock::Moment at(int endpoint, std::uint32_t ticks, TimeNs arrival_host);

  private:
    struct Stamp {
        std::uint32_t ticks = 0;
        TimeNs arrival = 0;
    };
    struct Endpoint {
        std::optional<DeviceClock> own;
        bool checked = false;
        std::optional<Stamp> last;
        DeviceClock::Moment newest;
        bool any = false;
    };

    std::mutex mutex_;
    DeviceClock shared_{kTicksPerSecond, 32};
    std::array<Endpoint, 2> endpoints_;
};

}  // namespace kino::kinect1
