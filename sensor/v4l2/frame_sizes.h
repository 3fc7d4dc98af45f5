#pragma once

#include <cstdint>

#include "base/error.h"
#include "sensor/v4l2/video_device.h"

namespace kino {

struct FrameSize {
    int width = 0;   ///< px
    int height = 0;  ///< px
};

/// The size on offer for the format nearest to `wanted`; {0, 0} where the driver does not list any.
[[nodiscard]] Result<FrameSize> nearest_frame_size(const VideoDevice& device, std::uint32_t fourcc,
                                                   FrameSize wanted);

/// The frame interval on offer nearest to 1 / `fps`, as numerator and denominator in seconds; that
/// of `fps` itself where the driver does not list any.
struct FrameInterval {
    std::uint32_t numerator = 1;
    std::uint32_t denominator = 30;
    [[nodiscard]] double hz() const {
        return numerator == 0 ? 0.0 : static_cast<double>(denominator) / numerator;
    }
};
[[nodiscard]] Result<FrameInterval> nearest_frame_interval(const VideoDevice& device,
                                                           std::uint32_t fourcc, FrameSize size,
                                                           double fps);

}  // namespace kino
