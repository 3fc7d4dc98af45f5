#include "sensor/live/set_builder.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "base/check.h"
#include "sensor/pairing.h"

namespace kino {
namespace {

constexpr std::array kLeadingOrder = {StreamKind::depth, StreamKind::color, StreamKind::infrared,
                                      StreamKind::motion, StreamKind::bodies};

TimeNs time_of(const BodyFrame& frame) {
    return frame.time;
}
template <class Frame>
TimeNs time_of(const Frame& frame) {
    return frame.header.host_time;
}

struct PutInto {
    FrameSet& set;
    void operator()(const std::shared_ptr<const DepthFrame>& frame) const { set.depth = frame; }
    void operator()(const std::shared_ptr<const ColorFrame>& frame) const { set.color = frame; }
    void operator()(const std::shared_ptr<const InfraredFrame>& frame) const {
        set.infrared = frame;
    }
    void operator()(const std::shared_ptr<const BodyFrame>& frame) const { set.bodies = frame; }
    void operator()(const std::shared_ptr<const MotionFrame>& frame) const { set.motion = frame; }
};

template <class Kept>
std::vector<TimeNs> times_of(const std::deque<Kept>& kept) {
    std::vector<TimeNs> times(kept.size());
    std::transform(kept.begin(), kept.end(), times.begin(), [](const Kept& k) { return k.time; });
    return times;
}

}  // namespace

TimeNs host_time_of(const StreamFrame& frame) {
    return std::visit([](const auto& f) { return time_of(*f); }, frame);
}

SetBuilder::SetBuilder(const SetBuilderOptions& options) : options_(options) {
    KINO_CHECK_LE(std::size_t{1}, options_.waiting_sets);
    KINO_CHECK_LE(std::size_t{2}, options_.history);
}

std::optional<StreamKind> SetBuilder::leader() const {
    for (const StreamKind kind : kLeadingOrder) {
        if (streams_[static_cast<std::size_t>(kind)].on) return kind;
    }
    return std::nullopt;
}

void SetBuilder::turn(StreamKind kind, bool on) {
    {
        const std::lock_guard lock(mutex_);
        stream(kind) = {on, {}};
        if (const auto now_leading = leader(); now_leading != leader_ || (kind == leader_ && !on)) {
            overtaken_ += static_cast<std::int64_t>(waiting_.size());
            waiting_.clear();
            leader_ = now_leading;
            if (leader_) stream(*leader_).kept.clear();
        }
    }
    changed_.notify_all();
}

void SetBuilder::put(StreamKind kind, StreamFrame frame) {
    {
        const std::lock_guard lock(mutex_);
        if (!stream(kind).on) return;
        const TimeNs time = host_time_of(frame);
        if (kind == leader_) {
            waiting_.push_back({time, now_ns() + options_.patience, std::move(frame)});
            // One more than may wait: the newest is not yet known to be better.
            if (waiting_.size() > options_.waiting_sets + 1) {
                waiting_.pop_front();
                ++overtaken_;
            }
        } else {
            std::deque<Kept>& kept = stream(kind).kept;
            kept.push_back({time, std::move(frame)});
            if (kept.size() > options_.history) kept.pop_front();
        }
    }
    changed_.notify_one();
}

bool SetBuilder::awaits_partner(const Leading& leading) const {
    return std::any_of(streams_.begin(), streams_.end(), [&](const Stream& s) {
        const bool follows = s.on && &s != &streams_[static_cast<std::size_t>(*leader_)];
        if (!follows || (!s.kept.empty() && s.kept.back().time >= leading.time)) return false;
        if (!options_.foresee || s.kept.size() < 3) return true;
        const TimeNs age = leading.time - s.kept.back().time;
        // Of the last two distances one may hold a frame that was lost.
        const auto last = s.kept.rbegin();
        const TimeNs period = std::min(last[0].time - last[1].time, last[1].time - last[2].time);
        // A stream that is behind by more than a frame has stopped and holds nothing up.
        // A sixteenth of the period is left to jitter.
        return age <= 2 * period && period - age <= age + period / 16;
    });
}

bool SetBuilder::ready(const Leading& leading, TimeNs now) const {
    return now >= leading.deadline || !awaits_partner(leading);
}

std::optional<FrameSet> SetBuilder::next(TimeNs timeout) {
    const TimeNs until = now_ns() + std::max<TimeNs>(0, timeout);
    std::unique_lock lock(mutex_);
    while (true) {
        const TimeNs now = now_ns();
        while (waiting_.size() > options_.waiting_sets && ready(waiting_[1], now)) {
            waiting_.pop_front();
            ++overtaken_;
        }
        TimeNs wake = until;
        if (!waiting_.empty()) {
            if (ready(waiting_.front(), now)) {
                FrameSet set = build(waiting_.front());
                waiting_.pop_front();
                return set;
            }
            wake = std::min(wake, waiting_.front().deadline);
        }
        if (now >= until) return std::nullopt;
        changed_.wait_until(lock,
                            std::chrono::steady_clock::time_point(std::chrono::nanoseconds(wake)));
    }
}

FrameSet SetBuilder::build(const Leading& leading) {
    FrameSet set;
    set.index = next_index_++;
    set.time = leading.time;
    std::visit(PutInto{set}, leading.frame);
    for (std::size_t k = 0; k < kKinds; ++k) {
        const auto kind = static_cast<StreamKind>(k);
        const std::deque<Kept>& kept = streams_[k].kept;
        if (!streams_[k].on || kind == leader_ || kept.empty()) continue;
        const std::vector<TimeNs> times = times_of(kept);
        const auto pairing = pair_in_time(times, leading.time, pairing_limit(times));
        if (!pairing) continue;
        // Only colour has a flag that says "old"; what the device feels changes slowly.
        if (kind == StreamKind::color) set.color_paired = pairing->paired;
        if (kind == StreamKind::infrared && !pairing->paired) continue;
        std::visit(PutInto{set}, kept[pairing->index].frame);
    }
    if (leader_ == StreamKind::color) set.color_paired = true;
    return set;
}

std::int64_t SetBuilder::overtaken() const {
    const std::lock_guard lock(mutex_);
    return overtaken_;
}

}  // namespace kino
