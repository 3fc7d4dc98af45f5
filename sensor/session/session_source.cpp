#include "sensor/session/session_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "sensor/openers.h"
#include "sensor/pairing.h"
#include "sensor/recorded_timeline.h"

namespace kino {
namespace {

constexpr TimeNs kMotionReach = 2 * kNsPerSecond;

/// The frames of one stream, times rising strictly.
struct Stream {
    StreamId id;
    std::vector<SessionEntry> frames;
    std::vector<TimeNs> times;
    TimeNs reach = 0;
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

StreamInfo describe_stream(const Stream& stream, const SessionReader& reader) {
    StreamInfo info;
    info.id = stream.id;
    for (const SessionTrack& track : reader.index().tracks) {
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

SourceInfo info_of(const SessionReader& reader, const std::vector<Stream>& streams,
                   const std::string& uri) {
    SourceInfo info = reader.index().source;
    info.uri = uri;
    if (info.name.empty()) info.name = std::filesystem::path(uri).filename().string();
    info.note = note_of(reader);
    for (const Stream& stream : streams) {
        info.streams.push_back(describe_stream(stream, reader));
    }
    return info;
}

bool holds_session(const std::filesystem::path& path) {
    const auto bytes = open_byte_source(path);
    return bytes && looks_like_session(**bytes);
}

Result<std::unique_ptr<Source>> open_session(const std::string& uri) {
    KINO_ASSIGN(auto reader, SessionReader::open(uri));
    return make_session_source(std::move(reader), uri);
}

/// Names of the sessions in a folder, sorted; none where there is no folder.
std::vector<std::string> sessions_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
         at.increment(error)) {
        if (at->path().extension() != ".mkv" || !holds_session(at->path())) continue;
        names.push_back(at->path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// The first of its streams leads.
class SessionSource final : public RecordedTimeline {
  public:
    SessionSource(std::unique_ptr<SessionReader> reader, std::vector<Stream> streams,
                  const std::string& uri)
        : RecordedTimeline(info_of(*reader, streams, uri), streams.front().times),
          reader_(std::move(reader)),
          streams_(std::move(streams)) {
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

    Result<RigParameters> calibration() const override { return reader_->index().rig; }

  private:
    Result<std::optional<FrameSet>> read_set(std::size_t index) override {
        FrameSet set;
        set.index = static_cast<std::int64_t>(index);
        const TimeNs time = times()[index];
        set.time = time;
        tell_events(index);
        place(set);
        for (std::size_t i = 0; i < streams_.size(); ++i) {
            const Stream& stream = streams_[i];
            if (!wants(i)) continue;
            std::optional<Pairing> pairing = Pairing{index, true};
            if (i != 0) pairing = pair_in_time(stream.times, time, stream.reach);
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
        for (const Event& event : recorded_) {
            const bool after = index == 0 || event.time > times()[index - 1];
            if (after && event.time <= times()[index]) tell(event);
        }
    }

    std::unique_ptr<SessionReader> reader_;
    std::vector<Stream> streams_;
    std::vector<Event> recorded_;
    std::vector<SessionPose> poses_;
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
    return std::make_unique<SessionSource>(std::move(reader), std::move(streams), uri);
}

SourceOpener session_opener() {
    SourceOpener opener;
    opener.name = "Kinoscope session";
    opener.uri_pattern = "FILE.mkv";
    opener.probe = [](const std::string& uri) { return holds_session(uri); };
    opener.open = open_session;
    return opener;
}

SourceOpener session_folder_opener() {
    SourceOpener opener;
    opener.name = "folder of a Kinoscope session";
    opener.uri_pattern = "FOLDER with a session";
    opener.probe = [](const std::string& uri) {
        return !tum_folder_opener().probe(uri) && !described_folder_opener().probe(uri) &&
               !sessions_in(uri).empty();
    };
    opener.open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
        const std::vector<std::string> names = sessions_in(uri);
        if (names.size() == 1) {
            return open_session((std::filesystem::path(uri) / names.front()).string());
        }
        return fail(fmt::format("holds {} sessions: {}", names.size(), fmt::join(names, ", ")), uri,
                    "name one of them");
    };
    return opener;
}

}  // namespace kino
