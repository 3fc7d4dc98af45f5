#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "sensor/live/device.h"
#include "sensor/v4l2/buffer_queue.h"
#include "sensor/v4l2/negotiation.h"
#include "sensor/v4l2/video_device.h"

namespace kino {

/// When the loop helps itself, and when it gives up.
struct CaptureLimits {
    TimeNs no_buffer = kNsPerSecond;        ///< without any buffer: streaming is started anew
    TimeNs no_frame = 5 * kNsPerSecond;     ///< buffers, but none good: the same
    TimeNs after_error = 10 * kNsPerMs;     ///< pause before the next try
    TimeNs after_restart = 100 * kNsPerMs;  ///< pause after a restart that failed
    int errors = 3;    ///< failed calls in a row before streaming is started anew
    int restarts = 3;  ///< restarts without one good frame between before the device is given up
};

/// What came of the buffers so far; each buffer is in exactly one of the first four.
struct CaptureCounts {
    std::int64_t frames = 0;   ///< put, complete
    std::int64_t damaged = 0;  ///< put with damaged rows
    std::int64_t bad = 0;      ///< dropped: the driver flagged them
    std::int64_t short_ = 0;   ///< dropped: incomplete in a way that cannot be marked
    std::int64_t missing = 0;  ///< never came: gaps in the driver's sequence
    std::int64_t errors = 0;   ///< failed calls
    std::int64_t restarts = 0;
};

/// Streams from one node, on a thread of its own.
///
/// A frame's lost_before counts dropped buffers and gaps; across a restart, what the nominal rate
/// would have given. Times are the driver's where it uses the monotonic clock, else those of the
/// moment a buffer was taken, and rise strictly. The device has gone (FrameIntake::lost, once) when
/// a call says ENODEV, poll says POLLHUP, the stream has ended (EPIPE), or restarts did not help.
class CaptureLoop {
  public:
    /// `device` outlives the loop.
    CaptureLoop(const VideoDevice& device, bool multi_planar, VideoMode mode, StreamId id,
                CaptureLimits limits = {});
    ~CaptureLoop() { stop(); }
    CaptureLoop(const CaptureLoop&) = delete;
    CaptureLoop& operator=(const CaptureLoop&) = delete;

    /// Not while it runs. Fails where buffers or streaming do, and once the device has gone.
    Result<void> start(FrameIntake& intake);
    /// On return nothing more is put, and buffers and mappings are gone.
    void stop();
    [[nodiscard]] CaptureCounts counts() const;

  private:
    enum class Next : std::uint8_t { step, restart, stop, gone };

    void run(FrameIntake& intake);
    [[nodiscard]] Next step(FrameIntake& intake);
    [[nodiscard]] Next take(FrameIntake& intake, bool poll_error);
    [[nodiscard]] Next restart();
    [[nodiscard]] Next trouble(const CallFailure& failure);
    [[nodiscard]] Next pause(TimeNs duration, Next then);
    void count_gap(const FilledBuffer& buffer, TimeNs time);
    [[nodiscard]] TimeNs rising_time(const FilledBuffer& buffer);
    void deliver(const FilledBuffer& buffer, FrameIntake& intake);

    const VideoDevice& device_;
    const VideoMode mode_;
    const StreamId id_;
    const CaptureLimits limits_;
    BufferQueue queue_;
    std::thread thread_;
    int event_ = -1;
    std::atomic<bool> gone_ = false;

    // Of the thread while it runs.
    std::string why_;
    TimeNs buffer_due_ = 0;
    TimeNs frame_due_ = 0;
    int errors_in_a_row_ = 0;
    int restarts_in_a_row_ = 0;
    bool after_restart_ = false;
    bool any_buffer_ = false;
    std::uint32_t last_sequence_ = 0;
    TimeNs last_time_ = 0;
    std::int64_t next_sequence_ = 0;
    std::int64_t lost_ = 0;

    std::atomic<std::int64_t> frames_ = 0, damaged_ = 0, bad_ = 0, short_ = 0, missing_ = 0,
                              errors_ = 0, restarts_ = 0;
};

}  // namespace kino
