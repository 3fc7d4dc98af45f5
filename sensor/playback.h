#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/time.h"
#include "sensor/source.h"

namespace kino {

enum class LoopMode : std::uint8_t {
    once,      ///< stops on the last frame
    loop,      ///< ... n-2, n-1, 0, 1 ...
    ping_pong  ///< ... n-2, n-1, n-2 ... 1, 0, 1 ...: the ends are not shown twice
};

/// Which frame of a timeline is due at a moment of the host clock. Holds numbers only: no thread,
/// no clock, no source; the same calls give the same frames. A host clock that runs backwards
/// stands still here.
class Playback {
  public:
    static constexpr double kMinSpeed = 0.1;
    static constexpr double kMaxSpeed = 8;

    /// Starts running at frame 0 at `host_now`. `times` rise strictly from 0, at least one; the
    /// last frame is shown for `last_frame_duration` > 0.
    Playback(std::vector<TimeNs> times, TimeNs last_frame_duration, LoopMode mode, TimeNs host_now);
    Playback(const Timeline& timeline, LoopMode mode, TimeNs host_now);

    /// The frame to show, 0 to frame_count()-1.
    [[nodiscard]] std::int64_t due(TimeNs host_now) const;
    /// Mode `once` has shown its last frame to its end.
    [[nodiscard]] bool finished(TimeNs host_now) const;

    void pause(TimeNs host_now);
    void resume(TimeNs host_now);  ///< a finished playback starts over
    [[nodiscard]] bool paused() const { return paused_; }

    /// Pauses and shows the next (+1) or previous (-1) frame in playing order; in a loop the ends
    /// join. False, and nothing moved, at the ends of mode `once`. A step and its opposite cancel.
    bool step(int direction, TimeNs host_now);

    /// Exact: due(host_now) is then `index`, kept inside the range. Goes on running or pausing.
    void seek(std::int64_t index, TimeNs host_now);

    void set_speed(double speed, TimeNs host_now);  ///< kept inside kMinSpeed to kMaxSpeed
    [[nodiscard]] double speed() const { return speed_; }
    void set_mode(LoopMode mode, TimeNs host_now);  ///< the frame shown stays
    [[nodiscard]] LoopMode mode() const { return mode_; }
    [[nodiscard]] std::int64_t frame_count() const {
        return static_cast<std::int64_t>(times_.size());
    }

  private:
    /// One frame's turn in playing order; a round of ping-pong has 2n-2 of them.
    struct Turn {
        TimeNs start = 0;
        std::int64_t index = 0;
    };
    void build_turns();
    [[nodiscard]] TimeNs media_time(TimeNs host_now) const;
    [[nodiscard]] std::size_t turn_at(TimeNs media) const;
    void go_to(TimeNs media, TimeNs host_now);

    std::vector<TimeNs> times_;
    TimeNs last_frame_duration_ = 0;
    LoopMode mode_ = LoopMode::loop;
    double speed_ = 1;
    bool paused_ = false;
    std::vector<Turn> turns_;
    TimeNs period_ = 0;
    /// Media time was anchor_media_ when the host clock was anchor_host_.
    TimeNs anchor_media_ = 0;
    TimeNs anchor_host_ = 0;
};

/// Ping-pong for moving pictures too short to loop with pleasure (under two seconds), else a loop.
[[nodiscard]] LoopMode natural_loop(const Timeline& timeline);

}  // namespace kino
