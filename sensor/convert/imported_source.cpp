#include "sensor/convert/imported_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/check.h"
#include "sensor/pairing.h"

namespace kino {
namespace {

constexpr TimeNs kMotionReach = kNsPerSecond;

TimeNs median_distance(const std::vector<TimeNs>& times) {
    if (times.size() < 2) return kNsPerSecond / 30;
    std::vector<TimeNs> distances(times.size() - 1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) distances[i] = times[i + 1] - times[i];
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

class ImportedSource final : public Source, public Timeline {
  public:
    explicit ImportedSource(Import import) : import_(std::move(import)) {
        KINO_CHECK(!import_.streams.empty() && !import_.streams.front().times.empty());
        import_.info.streams.clear();
        for (ImportedStream& stream : import_.streams) {
            KINO_CHECK_EQ(stream.times.size(), stream.frames.size());
            const TimeNs distance = median_distance(stream.times);
            if (stream.info.nominal_hz <= 0 && stream.times.size() > 1) {
                stream.info.nominal_hz = 1e9 / static_cast<double>(distance);
            }
            import_.info.streams.push_back(stream.info);
            State& state = states_.emplace_back();
            state.reach = stream.info.id.kind == StreamKind::motion ? kMotionReach
                                                                    : pairing_limit(stream.times);
        }
        last_frame_duration_ = median_distance(lead().times);
    }

    const SourceInfo& info() const override { return import_.info; }
    Result<RigParameters> calibration() const override { return import_.rig; }
    Timeline* timeline() override { return this; }

    Result<void> subscribe(StreamId id) override {
        for (std::size_t i = 0; i < states_.size(); ++i) {
            if (import_.streams[i].info.id != id) continue;
            states_[i].subscribed = true;
            return {};
        }
        return fail(fmt::format("this recording has no {} stream of device {}",
                                stream_name(id.kind), id.device),
                    import_.info.uri);
    }

    void unsubscribe(StreamId id) override {
        for (std::size_t i = 0; i < states_.size(); ++i) {
            if (import_.streams[i].info.id == id) states_[i].subscribed = false;
        }
    }

    bool set_tap(FrameTap tap) override {
        tap_ = std::move(tap);
        return true;
    }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        if (!std::exchange(started_, true)) {
            events_.push_back({EventKind::started, lead().times.front(), import_.info.name});
        }
        if (position_ >= frame_count()) {
            if (!std::exchange(ended_, true)) {
                events_.push_back({EventKind::ended, lead().times.back() + last_frame_duration_,
                                   import_.info.name});
            }
            return std::nullopt;
        }
        // Moved first: an unreadable frame is an error once, then the next one comes.
        const auto index = static_cast<std::size_t>(position_++);
        if (tap_) KINO_TRY(tell_tap(index));
        return read_set(index);
    }

    std::vector<Event> take_events() override { return std::exchange(events_, {}); }

    std::int64_t frame_count() const override {
        return static_cast<std::int64_t>(lead().times.size());
    }
    TimeNs time_of(std::int64_t index) const override {
        KINO_CHECK(index >= 0 && index < frame_count());
        return lead().times[static_cast<std::size_t>(index)] - lead().times.front();
    }
    TimeNs last_frame_duration() const override { return last_frame_duration_; }
    std::int64_t position() const override { return position_; }

    Result<void> seek(std::int64_t index) override {
        if (index < 0 || index >= frame_count()) {
            return fail(fmt::format("frame {} is outside 0 to {}", index, frame_count() - 1),
                        import_.info.uri);
        }
        position_ = index;
        ended_ = false;
        return {};
    }

  private:
    struct State {
        bool subscribed = false;
        TimeNs reach = 0;
        // The tap and the set mostly ask for the same frame.
        std::optional<std::size_t> kept_index;
        StreamFrame kept;
    };

    const ImportedStream& lead() const { return import_.streams.front(); }

    Result<StreamFrame> read(std::size_t stream, std::size_t index) {
        State& state = states_[stream];
        if (state.kept_index == index) return state.kept;
        const ImportedStream& imported = import_.streams[stream];
        KINO_ASSIGN(state.kept,
                    import_.reader->read(imported.info.id.kind, imported.frames[index]));
        state.kept_index = index;
        return state.kept;
    }

    /// Every frame behind the leading one before `index`, up to that one; at the end, all.
    Result<void> tell_tap(std::size_t index) {
        struct Due {
            TimeNs time;
            std::size_t stream;
            std::size_t frame;
        };
        std::vector<Due> due;
        const bool last = index + 1 == lead().times.size();
        for (std::size_t s = 0; s < states_.size(); ++s) {
            if (!states_[s].subscribed) continue;
            const std::vector<TimeNs>& times = import_.streams[s].times;
            auto at = index == 0
                          ? times.begin()
                          : std::upper_bound(times.begin(), times.end(), lead().times[index - 1]);
            for (; at != times.end() && (last || *at <= lead().times[index]); ++at) {
                due.push_back({*at, s, static_cast<std::size_t>(at - times.begin())});
            }
        }
        std::stable_sort(due.begin(), due.end(),
                         [](const Due& a, const Due& b) { return a.time < b.time; });
        std::optional<Error> first_error;
        for (const Due& entry : due) {
            auto frame = read(entry.stream, entry.frame);
            if (frame) {
                tap_(import_.streams[entry.stream].info.id, *frame);
            } else if (!first_error) {
                first_error = std::move(frame).error();
            }
        }
        if (first_error) return tl::unexpected<Error>(*std::move(first_error));
        return {};
    }

    Result<std::optional<FrameSet>> read_set(std::size_t index) {
        FrameSet set;
        set.index = static_cast<std::int64_t>(index);
        set.time = lead().times[index];
        for (std::size_t s = 0; s < states_.size(); ++s) {
            if (!states_[s].subscribed) continue;
            std::optional<Pairing> pairing = Pairing{index, true};
            if (s != 0) {
                pairing = pair_in_time(import_.streams[s].times, set.time, states_[s].reach);
            }
            const StreamKind kind = import_.streams[s].info.id.kind;
            if (!pairing || (!pairing->paired && kind != StreamKind::color)) continue;
            KINO_ASSIGN(const StreamFrame frame, read(s, pairing->index));
            if (const auto* depth = std::get_if<0>(&frame)) set.depth = *depth;
            if (const auto* color = std::get_if<1>(&frame)) {
                set.color = *color;
                set.color_paired = pairing->paired;
            }
            if (const auto* infrared = std::get_if<2>(&frame)) set.infrared = *infrared;
            if (const auto* motion = std::get_if<4>(&frame)) set.motion = *motion;
        }
        return set;
    }

    Import import_;
    std::vector<State> states_;
    TimeNs last_frame_duration_ = 0;
    FrameTap tap_;
    std::vector<Event> events_;
    std::int64_t position_ = 0;
    bool started_ = false;
    bool ended_ = false;
};

}  // namespace

std::unique_ptr<Source> make_imported_source(Import import) {
    return std::make_unique<ImportedSource>(std::move(import));
}

std::size_t keep_rising(ImportedStream& stream) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < stream.times.size(); ++i) {
        if (kept > 0 && stream.times[i] <= stream.times[kept - 1]) continue;
        stream.times[kept] = stream.times[i];
        stream.frames[kept++] = stream.frames[i];
    }
    const std::size_t dropped = stream.times.size() - kept;
    stream.times.resize(kept);
    stream.frames.resize(kept);
    return dropped;
}

}  // namespace kino
