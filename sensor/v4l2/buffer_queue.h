#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sensor/v4l2/video_device.h"

namespace kino {

/// What DQBUF gave: a buffer that is ours until it is queued again.
struct FilledBuffer {
    std::uint32_t index = 0;
    std::uint32_t sequence = 0;
    TimeNs stamp = 0;                     ///< on the monotonic clock; 0 if on another, or none
    bool bad = false;                     ///< the driver says that the content is wrong
    std::span<const std::uint8_t> bytes;  ///< what the driver filled, never beyond the mapping
};

/// The mapped buffers of a streaming node. Not thread-safe.
class BufferQueue {
  public:
    BufferQueue(const VideoDevice& device, bool multi_planar)
        : device_(device), multi_planar_(multi_planar) {}
    BufferQueue(const BufferQueue&) = delete;
    BufferQueue& operator=(const BufferQueue&) = delete;
    ~BufferQueue() { release(); }

    /// Asks for four buffers (fewer or more are taken), maps and queues them and starts streaming.
    /// They hold at least `least_bytes` each. On failure nothing is left behind.
    [[nodiscard]] Called start(std::size_t least_bytes);
    /// Never waits: EAGAIN where nothing is ready.
    [[nodiscard]] tl::expected<FilledBuffer, CallFailure> dequeue();
    [[nodiscard]] Called queue(std::uint32_t index);
    /// Queues every buffer that the driver neither holds nor offers: after an EIO it may have
    /// handed one out without saying which.
    [[nodiscard]] Called queue_strays();
    /// Stops and frees everything, whatever the driver says to it.
    void release();

  private:
    struct Mapping {
        void* data = nullptr;
        std::size_t length = 0;
    };
    [[nodiscard]] Called start_or_leave(std::size_t least_bytes);
    [[nodiscard]] Called map_buffer(std::uint32_t index, std::size_t least_bytes);
    [[nodiscard]] std::uint32_t type() const;

    const VideoDevice& device_;
    bool multi_planar_ = false;
    bool requested_ = false;
    bool streaming_ = false;
    std::vector<Mapping> mappings_;
};

}  // namespace kino
