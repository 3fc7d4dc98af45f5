#include "apps/viewer/frame_pacer.h"

#include <algorithm>

namespace kino {
namespace {

constexpr TimeNs kLeastPeriod = kNsPerMs;
/// Catching up, a period is at least nine tenths.
constexpr TimeNs kCatchUpParts = 10;

}  // namespace

FramePacer::FramePacer(TimeNs period) {
    set_period(period);
}

void FramePacer::set_period(TimeNs period) {
    period = std::max(kLeastPeriod, period);
    if (period == period_) return;
    period_ = period;
    turn_ = shown_ + period;
}

TimeNs FramePacer::turn() const {
    return std::max(turn_, shown_ + period_ - period_ / kCatchUpParts);
}

TimeNs FramePacer::begin_at(TimeNs now, TimeNs expected) const {
    return begun_ ? std::clamp(turn() - std::max<TimeNs>(0, expected), now, now + period_) : now;
}

TimeNs FramePacer::show_at(TimeNs now) const {
    return begun_ ? std::clamp(turn(), now, now + period_) : now;
}

void FramePacer::shown(TimeNs at) {
    const TimeNs behind = at - turn_;
    turn_ = begun_ && behind < period_ && behind > -period_ ? turn_ + period_ : at + period_;
    shown_ = at;
    begun_ = true;
}

}  // namespace kino
