#include "sensor/convert/imported_source.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/check.h"
#include "sensor/pairing.h"
#include "sensor/recorded_timeline.h"

namespace kino {
namespace {

constexpr TimeNs kMotionReach = kNsPerSecond;

/// With the streams' own descriptions, rates filled in where the file said none.
SourceInfo described(const Import& import) {
    SourceInfo info = import.info;
    info.streams.clear();
    for (const ImportedStream& stream : import.streams) {
        KINO_CHECK_EQ(stream.times.size(), stream.frames.size());
        StreamInfo& out = info.streams.emplace_back(stream.info);
        if (out.nominal_hz <= 0 && stream.times.size() > 1) {
            out.nominal_hz = 1e9 / static_cast<double>(median_distance(stream.times));
        }
    }
    return info;
}

const std::vector<TimeNs>& leading_times(const Import& import) {
    KINO_CHECK(!import.streams.empty());
    return import.streams.front().times;
}

class ImportedSource final : public RecordedTimeline {
  public:
    explicit ImportedSource(Import import)
        : RecordedTimeline(described(import), leading_times(import)), import_(std::move(import)) {
        for (const ImportedStream& stream : import_.streams) {
            states_.emplace_back().reach = stream.info.id.kind == StreamKind::motion
                                               ? kMotionReach
                                               : pairing_limit(stream.times);
        }
    }

    Result<RigParameters> calibration() const override { return import_.rig; }

    bool set_tap(FrameTap tap) override {
        tap_ = std::move(tap);
        return true;
    }

  private:
    struct State {
        TimeNs reach = 0;
        // The tap and the set mostly ask for the same frame.
        std::optional<std::size_t> kept_index;
        StreamFrame kept;
    };

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
        const bool last = index + 1 == times().size();
        for (std::size_t s = 0; s < states_.size(); ++s) {
            if (!wants(s)) continue;
            const std::vector<TimeNs>& all = import_.streams[s].times;
            auto at = index == 0 ? all.begin()
                                 : std::upper_bound(all.begin(), all.end(), times()[index - 1]);
            for (; at != all.end() && (last || *at <= times()[index]); ++at) {
                due.push_back({*at, s, static_cast<std::size_t>(at - all.begin())});
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

    Result<std::optional<FrameSet>> read_set(std::size_t index) override {
        if (tap_) KINO_TRY(tell_tap(index));
        FrameSet set;
        set.index = static_cast<std::int64_t>(index);
        set.time = times()[index];
        for (std::size_t s = 0; s < states_.size(); ++s) {
            if (!wants(s)) continue;
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
    FrameTap tap_;
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
