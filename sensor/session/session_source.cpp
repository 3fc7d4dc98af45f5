#include "sensor/session/session_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/check.h"
#include "sensor/pairing.h"

namespace kino {
namespace {

constexpr TimeNs kMotionReach = 2 * kNsPerSecond;

/// The frames of one stream, times rising strictly.
struct Stream {
    StreamId id;
    std::vector<SessionEntry> frames;
    std::vector<TimeNs> times;
    TimeNs reach = 0;
    bool subscribed = false;
};

void finish(Stream& stream) {
    std::stable_sort(stream.frames.begin(), stream.frames.end(),
                     [](const SessionEntry& a, const SessionEntry& b) {
                         return std::pair(a.time, a.device_time) < std::pair(b.time, b.device_time);
                     });
    stream.times.reserve(stream.frames.size());
    for (const SessionEntry& frame : stream.frames) {
        const TimeNs after = stream.times.empty() ? frame.time : stream.times.back() + 1;
        stream.times.push_back(std::max(frame.time, after));
    }
    stream.reach =
        stream.id.kind == StreamKind::motion ? kMotionReach : pairing_limit(stream.times);
}

TimeNs median_distance(const std::vector<TimeNs>& times) {
    if (times.size() < 2) return kNsPerSecond / 30;
    std::vector<TimeNs> distances(times.size() - 1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) distances[i] = times[i + 1] - times[i];
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

std::string note_of(const SessionReader& reader) {
    std::string note = reader.index().source.note;
    const auto add = [&note](const std::string& text) {
        if (!note.empty()) note += "; ";
        note += text;
    };
    for (const std::string& finding : reader.index().findings) add(finding);
    std::int64_t dropped = 0;
    std::int64_t refused = 0;
    for (const SessionEvent& event : reader.events()) {
        if (event.kind == "dropped") dropped += std::max<std::int64_t>(event.count, 0) % 1'000'000;
        if (event.kind == "refused") refused += std::max<std::int64_t>(event.count, 0) % 1'000'000;
    }
    if (dropped > 0) add(fmt::format("{} frames were dropped while recording", dropped));
    if (refused > 0) add(fmt::format("{} frames could not be recorded", refused));
    return note;
}

class SessionSource final : public Source, public Timeline {
  public:
    SessionSource(std::unique_ptr<SessionReader> reader, std::vector<Stream> streams,
                  std::size_t lead, const std::string& uri)
        : reader_(std::move(reader)), streams_(std::move(streams)), lead_(lead) {
        info_ = reader_->index().source;
        info_.uri = uri;
        if (info_.name.empty()) info_.name = std::filesystem::path(uri).filename().string();
        info_.note = note_of(*reader_);
        for (const Stream& stream : streams_) info_.streams.push_back(describe_stream(stream));
        last_frame_duration_ = median_distance(lead_stream().times);
        for (const SessionEvent& event : reader_->events()) {
            if (event.kind == "lost")
                recorded_.push_back({EventKind::lost, event.time, event.text});
            if (event.kind == "back")
                recorded_.push_back({EventKind::back, event.time, event.text});
            if (event.kind == "gesture") {
                recorded_.push_back({EventKind::gesture, event.time, event.text, event.detail});
            }
        }
        std::stable_sort(recorded_.begin(), recorded_.end(),
                         [](const Event& a, const Event& b) { return a.time < b.time; });
        for (const SessionPose& pose : reader_->poses()) poses_.push_back(pose);
        std::stable_sort(
            poses_.begin(), poses_.end(),
            [](const SessionPose& a, const SessionPose& b) { return a.time < b.time; });
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return reader_->index().rig; }
    Timeline* timeline() override { return this; }

    Result<void> subscribe(StreamId id) override {
        for (Stream& stream : streams_) {
            if (stream.id == id) {
                stream.subscribed = true;
                return {};
            }
        }
        return fail(fmt::format("this recording has no {} stream of device {}",
                                stream_name(id.kind), id.device),
                    info_.uri);
    }

    void unsubscribe(StreamId id) override {
        for (Stream& stream : streams_) {
            if (stream.id == id) stream.subscribed = false;
        }
    }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        if (!std::exchange(started_, true)) {
            events_.push_back({EventKind::started, lead_stream().times.front(), info_.name});
        }
        if (position_ >= frame_count()) {
            if (!std::exchange(ended_, true)) {
                events_.push_back({EventKind::ended,
                                   lead_stream().times.back() + last_frame_duration_, info_.name});
            }
            return std::nullopt;
        }
        // Moved first: an unreadable frame is an error once, then the next one comes.
        return read_set(static_cast<std::size_t>(position_++));
    }

    std::vector<Event> take_events() override { return std::exchange(events_, {}); }

    std::int64_t frame_count() const override {
        return static_cast<std::int64_t>(lead_stream().times.size());
    }
    TimeNs time_of(std::int64_t index) const override {
        KINO_CHECK(index >= 0 && index < frame_count());
        return lead_stream().times[static_cast<std::size_t>(index)] - lead_stream().times.front();
    }
    TimeNs last_frame_duration() const override { return last_frame_duration_; }
    std::int64_t position() const override { return position_; }

    Result<void> seek(std::int64_t index) override {
        if (index < 0 || index >= frame_count()) {
            return fail(fmt::format("frame {} is outside 0 to {}", index, frame_count() - 1),
                        info_.uri);
        }
        position_ = index;
        ended_ = false;
        return {};
    }

  private:
    const Stream& lead_stream() const { return streams_[lead_]; }

    StreamInfo describe_stream(const Stream& stream) const {
        StreamInfo info;
        info.id = stream.id;
        for (const SessionTrack& track : reader_->index().tracks) {
            if (track.role != TrackRole::picture || track.format.id != stream.id) continue;
            info.width = track.format.image.width;
            info.height = track.format.image.height;
            info.nominal_hz = track.nominal_hz;
            info.format = describe(track.format);
            break;
        }
        if (info.format.empty()) info.format = "as each frame says";
        if (info.nominal_hz <= 0 && stream.times.size() > 1) {
            info.nominal_hz = 1e9 / static_cast<double>(median_distance(stream.times));
        }
        return info;
    }

    Result<std::optional<FrameSet>> read_set(std::size_t index) {
        FrameSet set;
        set.index = static_cast<std::int64_t>(index);
        const TimeNs time = lead_stream().times[index];
        set.time = time;
        tell_events(index);
        place(set);
        for (std::size_t i = 0; i < streams_.size(); ++i) {
            const Stream& stream = streams_[i];
            if (!stream.subscribed) continue;
            std::optional<Pairing> pairing = Pairing{index, true};
            if (i != lead_) pairing = pair_in_time(stream.times, time, stream.reach);
            if (!pairing) continue;
            const bool wanted = pairing->paired || stream.id.kind == StreamKind::color;
            if (!wanted) continue;
            KINO_ASSIGN(const StreamFrame frame, reader_->read(stream.frames[pairing->index]));
            put(set, frame);
            if (stream.id.kind == StreamKind::color) set.color_paired = pairing->paired;
        }
        return set;
    }

    static void put(FrameSet& set, const StreamFrame& frame) {
        struct Putter {
            FrameSet& set;
            void operator()(const std::shared_ptr<const DepthFrame>& f) const { set.depth = f; }
            void operator()(const std::shared_ptr<const ColorFrame>& f) const { set.color = f; }
            void operator()(const std::shared_ptr<const InfraredFrame>& f) const {
                set.infrared = f;
            }
            void operator()(const std::shared_ptr<const BodyFrame>& f) const { set.bodies = f; }
            void operator()(const std::shared_ptr<const MotionFrame>& f) const { set.motion = f; }
        };
        std::visit(Putter{set}, frame);
    }

    void place(FrameSet& set) const {
        const auto pose = std::lower_bound(
            poses_.begin(), poses_.end(), set.time,
            [](const SessionPose& candidate, TimeNs time) { return candidate.time < time; });
        if (pose == poses_.end() || pose->time != set.time) return;
        set.world_from_depth = pose->world_from_depth;
        set.pose_origin = PoseOrigin::trajectory;
    }

    /// What happened between the frame before and this one.
    void tell_events(std::size_t index) {
        const std::vector<TimeNs>& times = lead_stream().times;
        for (const Event& event : recorded_) {
            const bool after = index == 0 || event.time > times[index - 1];
            if (after && event.time <= times[index]) events_.push_back(event);
        }
    }

    std::unique_ptr<SessionReader> reader_;
    std::vector<Stream> streams_;
    std::size_t lead_;
    SourceInfo info_;
    std::vector<Event> recorded_;
    std::vector<SessionPose> poses_;
    TimeNs last_frame_duration_ = 0;
    std::vector<Event> events_;
    std::int64_t position_ = 0;
    bool started_ = false;
    bool ended_ = false;
};

}  // namespace

Result<std::unique_ptr<Source>> make_session_source(std::unique_ptr<SessionReader> reader,
                                                    const std::string& uri) {
    std::vector<Stream> streams;
    for (const SessionEntry& frame : reader->frames()) {
        auto stream = std::find_if(streams.begin(), streams.end(),
                                   [&](const Stream& other) { return other.id == frame.id; });
        if (stream == streams.end()) {
            streams.emplace_back().id = frame.id;
            stream = std::prev(streams.end());
        }
        stream->frames.push_back(frame);
    }
    // Depth leads, of the device with the smallest number.
    const auto rank = [](const Stream& stream) {
        constexpr std::array<int, 5> kByKind = {0, 2, 1, 9, 9};  // depth, color, infrared, texts
        return std::pair(kByKind[static_cast<std::size_t>(stream.id.kind)], stream.id.device);
    };
    std::sort(streams.begin(), streams.end(),
              [&](const Stream& a, const Stream& b) { return rank(a) < rank(b); });
    if (streams.empty() || rank(streams.front()).first > 2) {
        return fail("the session holds no pictures", uri);
    }
    const int device = streams.front().id.device;
    std::erase_if(streams, [&](const Stream& stream) { return stream.id.device != device; });
    for (Stream& stream : streams) finish(stream);
    return std::make_unique<SessionSource>(std::move(reader), std::move(streams), 0, uri);
}

SourceOpener session_opener() {
    SourceOpener opener;
    opener.name = "Kinoscope session";
    opener.uri_pattern = "FILE.mkv";
    opener.probe = [](const std::string& uri) {
        const auto bytes = open_byte_source(uri);
        return bytes && looks_like_session(**bytes);
    };
    opener.open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
        KINO_ASSIGN(auto reader, SessionReader::open(uri));
        return make_session_source(std::move(reader), uri);
    };
    return opener;
}

}  // namespace kino
