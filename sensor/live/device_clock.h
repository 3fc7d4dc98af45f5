#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "base/time.h"

namespace kino {

/// Turns the raw counter that a device stamps its frames with into rising times. The counter has
/// `bits` bits and wraps; its true rate is near the nominal one and is learnt. Arrival on the host
/// is never early, only late, so host time is a line under all recent points (counter, arrival):
/// the edge of their lower convex hull below the middle of the window (Moon, Skelly & Towsley
/// 1999, "Estimation and removal of clock skew from network delay measurements"). What the line
/// cannot know is the least delay of all, which stays in it.
///
/// Several streams stamped by one counter share one clock; stamps may go back a quarter of a
/// second (or a quarter of the counter's range, if that is less). Not thread-safe.
class DeviceClock {
  public:
    /// `ticks_per_second` > 0; `bits` from 8 to 64. Arrivals may scatter over at most three
    /// quarters of the counter's range.
    DeviceClock(double ticks_per_second, int bits);

    struct Moment {
        TimeNs device_time = 0;  ///< unwrapped, at the nominal rate; 0 is the first stamp
        TimeNs host_time = 0;    ///< never after the arrival
    };
    /// Both times rise strictly with every stamp that is newer than all before it, through wraps,
    /// resets and jumps; an older stamp gets times no later than the newest's. `arrival` is a host
    /// time (now_ns()); one that runs backwards stands still here.
    [[nodiscard]] Moment at(std::uint64_t ticks, TimeNs arrival);

    /// The counter may have started anew (the device was plugged in again): the next stamp stands
    /// where the host says that time has gone on to. The learnt rate stays.
    void restart();

    /// As learnt so far; the nominal one in the first second.
    [[nodiscard]] double ticks_per_second() const;
    /// Resets and jumps found, without calls of restart().
    [[nodiscard]] std::int64_t jumps() const { return jumps_; }

  private:
    struct Point {
        TimeNs device_time = 0;
        TimeNs arrival = 0;
    };
    [[nodiscard]] TimeNs map(TimeNs device_time) const;
    [[nodiscard]] bool unwrap(std::uint64_t ticks, TimeNs arrival);
    [[nodiscard]] bool late_for_long(TimeNs arrival);
    void begin_epoch(std::uint64_t ticks, TimeNs arrival);
    void learn(Point point);
    void fit();

    double ns_per_tick_;
    std::uint64_t mask_;
    double range_ns_;  ///< of the counter

    bool running_ = false;  ///< within an epoch: stamps since the last reset
    std::uint64_t last_ticks_ = 0;
    std::int64_t epoch_ticks_ = 0;  ///< unwrapped, since the epoch's first stamp
    TimeNs epoch_start_ = 0;        ///< device time of the epoch's first stamp
    TimeNs device_time_ = 0;        ///< of the last stamp

    bool any_ = false;
    TimeNs last_arrival_ = 0;
    TimeNs newest_device_time_ = 0;
    TimeNs newest_host_time_ = 0;
    TimeNs late_since_ = -1;
    std::int64_t jumps_ = 0;

    /// Least delayed stamp of every stretch of time, oldest first; the last one is growing.
    std::deque<Point> points_;
    TimeNs stretch_end_ = 0;
    Point anchor_;     ///< the line goes through it
    double skew_ = 0;  ///< the line's slope less 1, host ns a device ns
    bool learnt_ = false;
};

}  // namespace kino
