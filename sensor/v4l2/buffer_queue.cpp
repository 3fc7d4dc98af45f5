#include "sensor/v4l2/buffer_queue.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>

namespace kino {
namespace {

constexpr std::uint32_t kWantedBuffers = 4;
/// No driver has that many; a wrong answer must not fill the memory.
constexpr std::uint32_t kMostBuffers = 256;

/// A v4l2_buffer together with the one plane it may point to.
struct BufferArgument {
    v4l2_buffer buffer{};
    v4l2_plane plane{};

    BufferArgument(std::uint32_t type, std::uint32_t index) {
        buffer.type = type;
        buffer.memory = V4L2_MEMORY_MMAP;
        buffer.index = index;
        if (type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
            buffer.m.planes = &plane;
            buffer.length = 1;
        }
    }
    BufferArgument(const BufferArgument&) = delete;
    BufferArgument& operator=(const BufferArgument&) = delete;
};

TimeNs stamp_of(const v4l2_buffer& buffer) {
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
        return 0;
    const auto seconds = static_cast<TimeNs>(buffer.timestamp.tv_sec);
    const auto microseconds = static_cast<TimeNs>(buffer.timestamp.tv_usec);
    constexpr TimeNs kMostSeconds = TimeNs{1} << 32;
    if (seconds < 0 || seconds > kMostSeconds || microseconds < 0 || microseconds >= 1'000'000)
        return 0;
    return seconds * kNsPerSecond + microseconds * 1000;
}

tl::unexpected<CallFailure> fails(int error, const char* call) {
    return tl::unexpected<CallFailure>({error, call});
}

}  // namespace

std::uint32_t BufferQueue::type() const {
    return multi_planar_ ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

Called BufferQueue::start(std::size_t least_bytes) {
    Called started = start_or_leave(least_bytes);
    if (!started) release();
    return started;
}

Called BufferQueue::start_or_leave(std::size_t least_bytes) {
    v4l2_requestbuffers request{};
    request.count = kWantedBuffers;
    request.type = type();
    request.memory = V4L2_MEMORY_MMAP;
    requested_ = true;
    KINO_TRY_CALL(device_.call(VIDIOC_REQBUFS, request));
    if (request.count == 0) return fails(ENOMEM, "VIDIOC_REQBUFS");
    for (std::uint32_t i = 0; i < std::min(request.count, kMostBuffers); ++i)
        KINO_TRY_CALL(map_buffer(i, least_bytes));
    for (std::uint32_t i = 0; i < mappings_.size(); ++i) KINO_TRY_CALL(queue(i));
    auto wanted = static_cast<int>(type());
    streaming_ = true;  // also where it fails: STREAMOFF gives the queued buffers back
    return device_.call(VIDIOC_STREAMON, wanted);
}

Called BufferQueue::map_buffer(std::uint32_t index, std::size_t least_bytes) {
    BufferArgument query(type(), index);
    KINO_TRY_CALL(device_.call(VIDIOC_QUERYBUF, query.buffer));
    const std::size_t length = multi_planar_ ? query.plane.length : query.buffer.length;
    const std::uint32_t offset = multi_planar_ ? query.plane.m.mem_offset : query.buffer.m.offset;
    if (length == 0 || length < least_bytes) return fails(ENOBUFS, "VIDIOC_QUERYBUF");
    const MapResult mapped = device_.map(length, offset);
    if (mapped.error != 0) return fails(mapped.error, "mmap");
    mappings_.push_back({mapped.data, length});
    return {};
}

tl::expected<FilledBuffer, CallFailure> BufferQueue::dequeue() {
    BufferArgument taken(type(), 0);
    KINO_TRY_CALL(device_.call(VIDIOC_DQBUF, taken.buffer));
    const v4l2_buffer& buffer = taken.buffer;
    if (buffer.index >= mappings_.size()) return fails(EIO, "VIDIOC_DQBUF");

    FilledBuffer filled;
    filled.index = buffer.index;
    filled.sequence = buffer.sequence;
    filled.stamp = stamp_of(buffer);
    filled.bad = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
    std::size_t end = multi_planar_ ? taken.plane.bytesused : buffer.bytesused;
    std::size_t begin = multi_planar_ ? taken.plane.data_offset : 0;
    const Mapping& mapping = mappings_[buffer.index];
    if (end > mapping.length || begin > end) {
        filled.bad = true;
        begin = end = 0;
    }
    filled.bytes = {static_cast<const std::uint8_t*>(mapping.data) + begin, end - begin};
    return filled;
}

Called BufferQueue::queue(std::uint32_t index) {
    BufferArgument given(type(), index);
    return device_.call(VIDIOC_QBUF, given.buffer);
}

Called BufferQueue::queue_strays() {
    for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
        BufferArgument query(type(), i);
        KINO_TRY_CALL(device_.call(VIDIOC_QUERYBUF, query.buffer));
        constexpr std::uint32_t kHeld = V4L2_BUF_FLAG_QUEUED | V4L2_BUF_FLAG_DONE;
        if ((query.buffer.flags & kHeld) == 0) KINO_TRY_CALL(queue(i));
    }
    return {};
}

void BufferQueue::release() {
    // What failed now is tried again by the next release: a driver that still streams would refuse
    // new buffers.
    if (streaming_) {
        auto wanted = static_cast<int>(type());
        streaming_ = !device_.call(VIDIOC_STREAMOFF, wanted).has_value();
    }
    for (const Mapping& mapping : mappings_)
        (void)device_.system().unmap(mapping.data, mapping.length);
    mappings_.clear();
    if (requested_) {
        v4l2_requestbuffers none{};
        none.type = type();
        none.memory = V4L2_MEMORY_MMAP;
        requested_ = !device_.call(VIDIOC_REQBUFS, none).has_value();
    }
}

}  // namespace kino
