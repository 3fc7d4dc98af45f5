#include "sensor/v4l2/frame_sizes.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>

#include "sensor/v4l2/buffer_decoder.h"

namespace kino {
namespace {

/// No driver lists so many; one that never ends its list must not hold us.
constexpr std::uint32_t kMostEntries = 512;

bool ends_list(int error) {
    return error == EINVAL || error == ENOTTY;
}

FrameSize sized(std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t kMost = kMaxVideoSize;
    return {static_cast<int>(std::min(width, kMost)), static_cast<int>(std::min(height, kMost))};
}

int stepped(int wanted, std::uint32_t least, std::uint32_t most, std::uint32_t step) {
    const auto low = static_cast<std::int64_t>(least);
    const auto high = std::clamp<std::int64_t>(most, low, std::max<std::int64_t>(low, 1 << 20));
    const std::int64_t stride = std::max<std::int64_t>(step, 1);
    const std::int64_t steps = (std::clamp<std::int64_t>(wanted, low, high) - low) / stride;
    return static_cast<int>(std::min<std::int64_t>(low + steps * stride, kMaxVideoSize));
}

double hz_of(const v4l2_fract& interval) {
    return interval.numerator == 0 ? 0
                                   : static_cast<double>(interval.denominator) / interval.numerator;
}

}  // namespace

Result<FrameSize> nearest_frame_size(const VideoDevice& device, std::uint32_t fourcc,
                                     FrameSize wanted) {
    FrameSize best;
    const auto distance = [&](const FrameSize& size) {
        return std::abs(size.width - wanted.width) + std::abs(size.height - wanted.height);
    };
    for (std::uint32_t i = 0; i < kMostEntries; ++i) {
        v4l2_frmsizeenum entry{};
        entry.index = i;
        entry.pixel_format = fourcc;
        if (const Called called = device.call(VIDIOC_ENUM_FRAMESIZES, entry); !called) {
            if (ends_list(called.error().error)) break;
            return device.fails(called.error());
        }
        if (entry.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
            const v4l2_frmsize_stepwise& range = entry.stepwise;
            return FrameSize{
                stepped(wanted.width, range.min_width, range.max_width, range.step_width),
                stepped(wanted.height, range.min_height, range.max_height, range.step_height)};
        }
        const FrameSize size = sized(entry.discrete.width, entry.discrete.height);
        if (best.width == 0 || distance(size) < distance(best)) best = size;
    }
    return best;
}

Result<FrameInterval> nearest_frame_interval(const VideoDevice& device, std::uint32_t fourcc,
                                             FrameSize size, double fps) {
    const FrameInterval exact{1000, static_cast<std::uint32_t>(std::lround(fps * 1000))};
    FrameInterval best = exact;
    double best_distance = -1;
    for (std::uint32_t i = 0; i < kMostEntries; ++i) {
        v4l2_frmivalenum entry{};
        entry.index = i;
        entry.pixel_format = fourcc;
        entry.width = static_cast<std::uint32_t>(size.width);
        entry.height = static_cast<std::uint32_t>(size.height);
        if (const Called called = device.call(VIDIOC_ENUM_FRAMEINTERVALS, entry); !called) {
            if (ends_list(called.error().error)) break;
            return device.fails(called.error());
        }
        // In a range the driver rounds better than we could.
        if (entry.type != V4L2_FRMIVAL_TYPE_DISCRETE) return exact;
        const double distance = std::abs(hz_of(entry.discrete) - fps);
        if (best_distance < 0 || distance < best_distance) {
            best = {entry.discrete.numerator, entry.discrete.denominator};
            best_distance = distance;
        }
    }
    return best;
}

}  // namespace kino
