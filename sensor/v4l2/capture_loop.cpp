#include "sensor/v4l2/capture_loop.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

namespace kino {
namespace {

bool is_damaged(const StreamFrame& frame) {
    return std::visit(
        [](const auto& held) {
            if constexpr (requires { held->damaged_rows; })
                return !held->damaged_rows.empty();
            else
                return false;
        },
        frame);
}

/// Drivers that do not count, or start anew, are not believed.
std::int64_t gap(std::uint32_t last, std::uint32_t now) {
    constexpr std::uint32_t kMostMissing = 100'000;
    const std::uint32_t step = now - last;
    return step >= 1 && step <= kMostMissing ? step - 1 : 0;
}

}  // namespace

CaptureLoop::CaptureLoop(const VideoDevice& device, bool multi_planar, VideoMode mode, StreamId id,
                         CaptureLimits limits)
    : device_(device),
      mode_(std::move(mode)),
      id_(id),
      limits_(limits),
      queue_(device, multi_planar) {}

Result<void> CaptureLoop::start(FrameIntake& intake) {
    if (gone_) return fail("the device has gone", device_.path(), "plug it in and open it again");
    const int event = device_.make_event();
    if (event < 0) return device_.fails({-event, "eventfd"});
    Called started = queue_.start(mode_.buffer_bytes);
    if (!started) {
        device_.system().close(event);
        return device_.fails(started.error());
    }
    event_ = event;
    try {
        thread_ = std::thread([this, &intake] { run(intake); });
    } catch (const std::system_error& error) {
        queue_.release();
        device_.system().close(std::exchange(event_, -1));
        return device_.fails({error.code().value(), "pthread_create"});
    }
    return {};
}

void CaptureLoop::stop() {
    if (!thread_.joinable()) return;
    device_.system().set_event(event_);
    thread_.join();
    device_.system().close(std::exchange(event_, -1));
}

CaptureCounts CaptureLoop::counts() const {
    return {frames_, damaged_, bad_, short_, missing_, errors_, restarts_};
}

void CaptureLoop::run(FrameIntake& intake) {
    const TimeNs now = device_.system().now();
    buffer_due_ = now + limits_.no_buffer;
    frame_due_ = now + limits_.no_frame;
    errors_in_a_row_ = restarts_in_a_row_ = 0;
    any_buffer_ = false;
    after_restart_ = last_time_ != 0;
    Next next = Next::step;
    while (next == Next::step || next == Next::restart)
        next = next == Next::step ? step(intake) : restart();
    queue_.release();
    if (next != Next::gone) return;
    gone_ = true;
    intake.lost(fmt::format("{}: {}", device_.path(), why_));
}

CaptureLoop::Next CaptureLoop::step(FrameIntake& intake) {
    const TimeNs now = device_.system().now();
    const TimeNs due = std::min(buffer_due_, frame_due_);
    if (now >= due) {
        why_ = fmt::format(
            "no {} for {:.1f} s", buffer_due_ <= frame_due_ ? "buffer" : "good frame",
            to_seconds(buffer_due_ <= frame_due_ ? limits_.no_buffer : limits_.no_frame));
        return Next::restart;
    }
    const PollResult found = device_.poll(event_, due - now);
    if (found.stopped) return Next::stop;
    if (found.error == EINTR || found.error == EAGAIN) return Next::step;
    if (found.error != 0) return trouble({found.error, "poll"});
    if ((found.events & (POLLHUP | POLLNVAL)) != 0) {
        why_ = "the device was unplugged";
        return Next::gone;
    }
    if (found.events == 0) return Next::step;
    // POLLERR alone is no unplugging: nothing may be queued, or streaming has stopped. DQBUF tells.
    return take(intake, (found.events & POLLERR) != 0);
}

CaptureLoop::Next CaptureLoop::take(FrameIntake& intake, bool poll_error) {
    const auto filled = queue_.dequeue();
    if (!filled) {
        if (filled.error().error != EAGAIN) return trouble(filled.error());
        if (poll_error) {
            if (const Called queued = queue_.queue_strays(); !queued)
                return trouble(queued.error());
        }
        return pause(limits_.after_error, Next::step);
    }
    buffer_due_ = device_.system().now() + limits_.no_buffer;
    deliver(*filled, intake);
    if (const Called queued = queue_.queue(filled->index); !queued) return trouble(queued.error());
    return Next::step;
}

void CaptureLoop::deliver(const FilledBuffer& buffer, FrameIntake& intake) {
    const TimeNs time = rising_time(buffer);
    count_gap(buffer, time);
    if (buffer.bad) {
        ++bad_;
        ++lost_;
        return;
    }
    FrameHeader header;
    header.device_time = header.host_time = time;
    header.lost_before = lost_;
    header.sequence = next_sequence_ + lost_;
    auto frame = decode_buffer(mode_.layout, buffer.bytes, header);
    if (!frame) {
        ++short_;
        ++lost_;
        return;
    }
    ++(is_damaged(*frame) ? damaged_ : frames_);
    next_sequence_ = header.sequence + 1;
    lost_ = 0;
    errors_in_a_row_ = restarts_in_a_row_ = 0;
    frame_due_ = device_.system().now() + limits_.no_frame;
    intake.put(id_, std::move(*frame));
}

void CaptureLoop::count_gap(const FilledBuffer& buffer, TimeNs time) {
    std::int64_t missing = 0;
    if (any_buffer_) {
        missing = gap(last_sequence_, buffer.sequence);
    } else if (after_restart_ && mode_.hz > 0) {
        const auto periods = std::llround(to_seconds(time - last_time_) * mode_.hz);
        missing = std::max<std::int64_t>(0, periods - 1);
    }
    any_buffer_ = true;
    last_sequence_ = buffer.sequence;
    last_time_ = time;
    missing_ += missing;
    lost_ += missing;
}

TimeNs CaptureLoop::rising_time(const FilledBuffer& buffer) {
    const TimeNs now = device_.system().now();
    const bool usable = buffer.stamp > 0 && buffer.stamp <= now + kNsPerSecond;
    const TimeNs time = usable ? buffer.stamp : now;
    return last_time_ == 0 ? time : std::max(time, last_time_ + 1);
}

CaptureLoop::Next CaptureLoop::trouble(const CallFailure& failure) {
    ++errors_;
    why_ = describe(failure);
    if (means_gone(failure.error)) {
        why_ = "the device was unplugged: " + why_;
        return Next::gone;
    }
    if (failure.error == EPIPE) {
        why_ = "the stream has ended: " + why_;
        return Next::gone;
    }
    // EINVAL: the driver has stopped streaming by itself.
    if (failure.error == EINVAL || ++errors_in_a_row_ >= limits_.errors) return Next::restart;
    if (const Called queued = queue_.queue_strays(); !queued && means_gone(queued.error().error))
        return trouble(queued.error());
    return pause(limits_.after_error, Next::step);
}

CaptureLoop::Next CaptureLoop::restart() {
    if (restarts_in_a_row_ >= limits_.restarts) {
        why_ += fmt::format("; starting anew {} times did not help", limits_.restarts);
        return Next::gone;
    }
    ++restarts_in_a_row_;
    ++restarts_;
    queue_.release();
    any_buffer_ = false;
    after_restart_ = last_time_ != 0;
    if (const Called started = queue_.start(mode_.buffer_bytes); !started) {
        const Next next = trouble(started.error());
        if (next == Next::gone || next == Next::stop) return next;
        return pause(limits_.after_restart, Next::restart);
    }
    errors_in_a_row_ = 0;
    const TimeNs now = device_.system().now();
    buffer_due_ = now + limits_.no_buffer;
    frame_due_ = now + limits_.no_frame;
    return Next::step;
}

CaptureLoop::Next CaptureLoop::pause(TimeNs duration, Next then) {
    // The node itself is not waited for: it may be in error, which would end every wait at once.
    const PollResult found = device_.system().poll(-1, event_, duration);
    return found.stopped ? Next::stop : then;
}

}  // namespace kino
