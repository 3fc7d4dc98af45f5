#include "sensor/live/device_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr TimeNs kStretch = kNsPerSecond / 4;
constexpr TimeNs kWindow = 60 * kNsPerSecond;
/// Before that much is known, jitter would be taken for drift.
constexpr TimeNs kMinSpan = kNsPerSecond;
constexpr double kMaxSkew = 0.05;
constexpr double kBackNs = 0.25e9;
constexpr double kEarlyNs = 0.1e9;
/// A stamp may be late because this process stood still, but not one after another for long.
constexpr TimeNs kLate = kNsPerSecond;
constexpr TimeNs kLateFor = 2 * kNsPerSecond;

}  // namespace

DeviceClock::DeviceClock(double ticks_per_second, int bits) {
    KINO_CHECK(std::isfinite(ticks_per_second));
    KINO_CHECK_LT(0.0, ticks_per_second);
    KINO_CHECK_LE(8, bits);
    KINO_CHECK_LE(bits, 64);
    ns_per_tick_ = 1e9 / ticks_per_second;
    mask_ = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    range_ns_ = std::ldexp(ns_per_tick_, bits);
}

double DeviceClock::ticks_per_second() const {
    return 1e9 / (ns_per_tick_ * (1 + skew_));
}

void DeviceClock::restart() {
    running_ = false;
}

TimeNs DeviceClock::map(TimeNs device_time) const {
    const TimeNs since = device_time - anchor_.device_time;
    return anchor_.arrival + since + std::llround(skew_ * static_cast<double>(since));
}

DeviceClock::Moment DeviceClock::at(std::uint64_t ticks, TimeNs arrival) {
    if (any_) arrival = std::max(arrival, last_arrival_);
    ticks &= mask_;
    if (!running_) {
        begin_epoch(ticks, arrival);
    } else if (!unwrap(ticks, arrival) || late_for_long(arrival)) {
        ++jumps_;
        begin_epoch(ticks, arrival);
    }
    last_arrival_ = arrival;
    learn({device_time_, arrival});

    Moment moment{device_time_, std::min(map(device_time_), arrival)};
    if (!any_ || moment.device_time > newest_device_time_) {
        if (any_) moment.host_time = std::max(moment.host_time, newest_host_time_ + 1);
        newest_device_time_ = moment.device_time;
        newest_host_time_ = moment.host_time;
        any_ = true;
    } else {
        moment.host_time = std::min(moment.host_time, newest_host_time_);
    }
    return moment;
}

bool DeviceClock::unwrap(std::uint64_t ticks, TimeNs arrival) {
    const double back = std::min(kBackNs, range_ns_ / 4);
    const double since_last = static_cast<double>(arrival - last_arrival_);
    const double early =
        std::min(kEarlyNs + (learnt_ ? 0.002 : kMaxSkew) * since_last, range_ns_ / 4);

    const std::uint64_t forward = (ticks - last_ticks_) & mask_;
    const std::uint64_t backward = (last_ticks_ - ticks) & mask_;
    const bool goes_back = static_cast<double>(backward) * ns_per_tick_ <= back;
    double step = goes_back ? -static_cast<double>(backward) : static_cast<double>(forward);

    // Whole rounds of the counter that fit before the arrival: frames may have been absent for
    // longer than one.
    const double room =
        static_cast<double>(arrival - map(device_time_)) + early - step * ns_per_tick_;
    if (room < 0) return false;
    step += std::floor(room / range_ns_) * (range_ns_ / ns_per_tick_);

    epoch_ticks_ += static_cast<std::int64_t>(step);
    last_ticks_ = ticks;
    const auto since_epoch = static_cast<long double>(epoch_ticks_) * ns_per_tick_;
    device_time_ = epoch_start_ + static_cast<TimeNs>(std::llround(since_epoch));
    return true;
}

bool DeviceClock::late_for_long(TimeNs arrival) {
    if (arrival - map(device_time_) <= kLate) {
        late_since_ = -1;
        return false;
    }
    if (late_since_ < 0) late_since_ = arrival;
    return arrival - late_since_ > kLateFor;
}

void DeviceClock::begin_epoch(std::uint64_t ticks, TimeNs arrival) {
    if (any_) {
        const TimeNs gone = std::max<TimeNs>(1, arrival - newest_host_time_);
        const double at_device_rate = static_cast<double>(gone) / (1 + skew_);
        device_time_ =
            newest_device_time_ + std::max<TimeNs>(1, static_cast<TimeNs>(at_device_rate));
    }
    running_ = true;
    last_ticks_ = ticks;
    epoch_ticks_ = 0;
    epoch_start_ = device_time_;
    late_since_ = -1;
    points_.clear();
    anchor_ = {device_time_, arrival};
}

void DeviceClock::learn(Point point) {
    const auto delay = [this](const Point& p) { return p.arrival - map(p.device_time); };
    if (points_.empty() || point.device_time >= stretch_end_) {
        points_.push_back(point);
        stretch_end_ = point.device_time + kStretch;
        while (points_.back().device_time - points_.front().device_time > kWindow) {
            points_.pop_front();
        }
        fit();
    } else if (delay(point) < delay(points_.back())) {
        points_.back() = point;
        if (delay(point) < 0) fit();
    }
}

void DeviceClock::fit() {
    // Stamps of two streams may have swapped places across the edge of a stretch.
    std::vector<Point> sorted(points_.begin(), points_.end());
    std::sort(sorted.begin(), sorted.end(), [](const Point& a, const Point& b) {
        return a.device_time < b.device_time ||
               (a.device_time == b.device_time && a.arrival < b.arrival);
    });
    const Point origin = sorted.front();
    const auto x = [&](const Point& p) {
        return static_cast<double>(p.device_time - origin.device_time);
    };
    // Delay against the nominal rate: small numbers, so nothing cancels.
    const auto y = [&](const Point& p) {
        return static_cast<double>(p.arrival - origin.arrival) - x(p);
    };
    const double span = x(sorted.back());
    if (span >= static_cast<double>(kMinSpan)) {
        std::vector<Point> hull;
        for (const Point& p : sorted) {
            while (hull.size() >= 2) {
                const Point& a = hull[hull.size() - 2];
                const Point& b = hull.back();
                if ((x(b) - x(a)) * (y(p) - y(a)) > (y(b) - y(a)) * (x(p) - x(a))) break;
                hull.pop_back();
            }
            if (hull.empty() || p.device_time > hull.back().device_time) hull.push_back(p);
        }
        std::size_t right = 1;
        while (right + 1 < hull.size() && x(hull[right]) < span / 2) ++right;
        const double rise = y(hull[right]) - y(hull[right - 1]);
        skew_ = std::clamp(rise / (x(hull[right]) - x(hull[right - 1])), -kMaxSkew, kMaxSkew);
        learnt_ = true;
    }
    anchor_ = *std::min_element(sorted.begin(), sorted.end(), [&](const Point& a, const Point& b) {
        return y(a) - skew_ * x(a) < y(b) - skew_ * x(b);
    });
}

}  // namespace kino
