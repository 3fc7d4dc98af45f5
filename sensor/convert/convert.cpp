#include "sensor/convert/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "sensor/convert/folder_frames.h"

namespace kino {
namespace {

struct Bounds {
    std::int64_t first = 0;
    std::int64_t end = 0;
};

Result<Bounds> bounds_of(Source& source, const ConvertRange& range) {
    Timeline* timeline = source.timeline();
    if (!timeline) {
        return fail("a live device is not converted", source.info().uri,
                    "`kinoscope record` writes a session of it");
    }
    const std::int64_t total = timeline->frame_count();
    if (range.from < 0 || range.from >= total) {
        return fail(fmt::format("frame {} is outside 0 to {}", range.from, total - 1),
                    source.info().uri);
    }
    const std::int64_t left = total - range.from;
    return Bounds{range.from, range.from + std::min(left, range.count.value_or(left))};
}

class Conversion {
  public:
    Conversion(Source& source, FrameSink& sink, Bounds bounds, const ConvertWatch& watch)
        : source_(source), sink_(sink), bounds_(bounds), watch_(watch) {}

    Result<ConvertReport> by_sets() {
        std::optional<Error> tap_error;
        const bool tapped =
            !sink_.takes_sets() && source_.set_tap([&](StreamId id, const StreamFrame& frame) {
                if (tap_error) return;
                if (auto put = sink_.put(id, frame, {}); !put) tap_error = std::move(put).error();
            });
        auto report = read_sets(tapped, tap_error);
        if (tapped) (void)source_.set_tap({});
        return report;
    }

    Result<ConvertReport> by_frames(SessionReader& session) {
        const auto [from, until] = time_range(session);
        const StreamId lead = source_.info().streams.front().id;
        // A text of events may lie anywhere: they go in where their time is.
        std::vector<SessionEvent> events = session.events();
        std::erase_if(events, [from = from, until = until](const SessionEvent& event) {
            return event.time < from || event.time >= until;
        });
        std::stable_sort(events.begin(), events.end(),
                         [](const auto& a, const auto& b) { return a.time < b.time; });
        std::size_t next_event = 0;
        std::vector<SessionPose> poses = session.poses();
        std::stable_sort(poses.begin(), poses.end(),
                         [](const auto& a, const auto& b) { return a.time < b.time; });
        for (const SessionEntry& entry : session.frames()) {
            if (entry.time < from || entry.time >= until) continue;
            for (; next_event < events.size() && events[next_event].time <= entry.time;
                 ++next_event) {
                put_event(events[next_event]);
            }
            auto frame = session.read(entry);
            if (!frame) {
                leave_out(frame.error());
            } else {
                std::optional<Pose> pose;
                if (entry.id.kind == StreamKind::depth) pose = pose_at(poses, entry.time);
                KINO_TRY(sink_.put(entry.id, *frame, pose));
            }
            if (entry.id == lead) {
                ++report_.frames;
                KINO_TRY(tell());
            }
        }
        for (; next_event < events.size(); ++next_event) put_event(events[next_event]);
        KINO_TRY(sink_.finish());
        return report_;
    }

  private:
    Result<ConvertReport> read_sets(bool tapped, const std::optional<Error>& tap_error) {
        KINO_TRY(source_.timeline()->seek(bounds_.first));
        for (std::int64_t i = bounds_.first; i < bounds_.end; ++i) {
            auto set = source_.next(0);
            for (const Event& event : source_.take_events()) {
                if (event.kind == EventKind::lost || event.kind == EventKind::back ||
                    event.kind == EventKind::gesture) {
                    sink_.put_event(event);
                }
            }
            if (tap_error) return tl::unexpected<Error>(*tap_error);
            if (!set) {
                leave_out(set.error());
            } else if (!*set) {
                break;
            } else {
                ++report_.frames;
                if (sink_.takes_sets()) {
                    KINO_TRY(sink_.put(**set));
                } else if (!tapped) {
                    KINO_TRY(put_apart(**set));
                }
            }
            KINO_TRY(tell());
        }
        KINO_TRY(sink_.finish());
        return report_;
    }

    /// A set's frames one by one, those that were not put before.
    Result<void> put_apart(const FrameSet& set) {
        const int device =
            source_.info().streams.empty() ? 0 : source_.info().streams.front().id.device;
        if (set.depth && repeats_[0].is_new(set.depth->header)) {
            std::optional<Pose> pose;
            if (set.pose_origin == PoseOrigin::trajectory) pose = set.world_from_depth;
            KINO_TRY(sink_.put({device, StreamKind::depth}, set.depth, pose));
        }
        if (set.color && repeats_[1].is_new(set.color->header)) {
            KINO_TRY(sink_.put({device, StreamKind::color}, set.color, {}));
        }
        if (set.infrared && repeats_[2].is_new(set.infrared->header)) {
            KINO_TRY(sink_.put({device, StreamKind::infrared}, set.infrared, {}));
        }
        if (set.bodies) KINO_TRY(sink_.put({device, StreamKind::bodies}, set.bodies, {}));
        if (set.motion && repeats_[3].is_new(set.motion->header)) {
            KINO_TRY(sink_.put({device, StreamKind::motion}, set.motion, {}));
        }
        return {};
    }

    /// Host times that lie in the range; a whole recording has no bounds.
    std::pair<TimeNs, TimeNs> time_range(const SessionReader& session) const {
        const StreamId lead = source_.info().streams.front().id;
        TimeNs start = std::numeric_limits<TimeNs>::max();
        for (const SessionEntry& entry : session.frames()) {
            if (entry.id == lead) start = std::min(start, entry.time);
        }
        const Timeline& timeline = *source_.timeline();
        TimeNs from = std::numeric_limits<TimeNs>::min();
        TimeNs until = std::numeric_limits<TimeNs>::max();
        if (bounds_.first > 0) from = start + timeline.time_of(bounds_.first);
        if (bounds_.end < timeline.frame_count()) until = start + timeline.time_of(bounds_.end);
        return {from, until};
    }

    static std::optional<Pose> pose_at(const std::vector<SessionPose>& poses, TimeNs time) {
        const auto at = std::lower_bound(
            poses.begin(), poses.end(), time,
            [](const SessionPose& pose, TimeNs wanted) { return pose.time < wanted; });
        if (at == poses.end() || at->time != time) return std::nullopt;
        return at->world_from_depth;
    }

    void put_event(const SessionEvent& event) {
        if (event.kind == "lost") sink_.put_event({EventKind::lost, event.time, event.text});
        if (event.kind == "back") sink_.put_event({EventKind::back, event.time, event.text});
        if (event.kind == "gesture") {
            sink_.put_event({EventKind::gesture, event.time, event.text, event.detail});
        }
    }

    void leave_out(const Error& error) {
        if (report_.unreadable++ == 0) report_.first_problem = error.to_string();
    }

    Result<void> tell() {
        ++told_;
        if (!watch_ || watch_(told_, bounds_.end - bounds_.first)) return {};
        return fail("interrupted: nothing was written");
    }

    Source& source_;
    FrameSink& sink_;
    Bounds bounds_;
    const ConvertWatch& watch_;
    std::int64_t told_ = 0;
    std::array<Repeats, 4> repeats_;
    ConvertReport report_;
};

}  // namespace

Result<ConvertReport> convert_recording(Source& source, SessionReader* session, FrameSink& sink,
                                        const ConvertRange& range, const ConvertWatch& watch) {
    KINO_ASSIGN(const Bounds bounds, bounds_of(source, range));
    Conversion conversion(source, sink, bounds, watch);
    if (session && !sink.takes_sets() && !source.info().streams.empty()) {
        return conversion.by_frames(*session);
    }
    return conversion.by_sets();
}

}  // namespace kino
