#include <algorithm>
#include <iterator>
#include <utility>

#include "sensor/live/composite_parts.h"
#include "sensor/live/live_source.h"

namespace kino {
namespace {

/// Takes the frames of both by their taps and pairs them itself.
class LiveComposite final : public LiveSource {
  public:
    LiveComposite(CompositeParts parts, const SetBuilderOptions& options)
        : sets_(options),
          parts_(std::move(parts)),
          info_(parts_.info()),
          controls_(merge_controls(parts_.depth->controls(), parts_.color->controls())) {}
    ~LiveComposite() override {
        (void)parts_.depth->set_tap({});
        (void)parts_.color->set_tap({});
    }

    bool listen() {
        const auto take = [this](StreamId id, const StreamFrame& frame) { put(id, frame); };
        return parts_.depth->set_tap(take) && parts_.color->set_tap(take);
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return parts_.calibration(); }
    Controls* controls() override { return controls_.get(); }

    Result<void> subscribe(StreamId id) override {
        if (in_sets(id)) sets_.turn(id.kind, true);
        auto subscribed = parts_.of(id.kind).subscribe(id);
        if (!subscribed && in_sets(id)) sets_.turn(id.kind, false);
        return subscribed;
    }
    void unsubscribe(StreamId id) override {
        parts_.of(id.kind).unsubscribe(id);
        if (in_sets(id)) sets_.turn(id.kind, false);
    }

    Result<std::optional<FrameSet>> next(TimeNs timeout) override { return sets_.next(timeout); }

    std::vector<Event> take_events() override {
        std::vector<Event> events = named_events(*parts_.depth);
        std::vector<Event> others = named_events(*parts_.color);
        // One start is enough; both were opened at once.
        std::erase_if(others, [](const Event& e) { return e.kind == EventKind::started; });
        std::vector<Event> merged;
        std::merge(events.begin(), events.end(), others.begin(), others.end(),
                   std::back_inserter(merged),
                   [](const Event& a, const Event& b) { return a.time < b.time; });
        return merged;
    }

    bool set_tap(FrameTap tap) override {
        const std::lock_guard lock(tap_mutex_);
        tap_.swap(tap);
        return true;
    }

    LiveStats stats() const override {
        LiveStats sum;
        for (const Source* part : {parts_.depth.get(), parts_.color.get()}) {
            const auto* live = dynamic_cast<const LiveSource*>(part);
            if (!live) continue;
            const LiveStats stats = live->stats();
            sum.frames += stats.frames;
            sum.losses += stats.losses;
            sum.present = sum.present && stats.present;
            if (sum.trouble.empty()) sum.trouble = stats.trouble;
        }
        sum.overtaken = sets_.overtaken();
        return sum;
    }

  private:
    void put(StreamId id, const StreamFrame& frame) {
        {
            const std::lock_guard lock(tap_mutex_);
            if (tap_) tap_(id, frame);
        }
        if (in_sets(id)) sets_.put(id.kind, frame);
    }

    std::vector<Event> named_events(Source& part) const {
        std::vector<Event> events = part.take_events();
        for (Event& event : events) {
            event.text = event.kind == EventKind::lost      ? part.info().name + ": " + event.text
                         : event.kind == EventKind::started ? info_.name
                                                            : event.text;
        }
        return events;
    }

    bool in_sets(StreamId id) const {
        const auto first = std::find_if(info_.streams.begin(), info_.streams.end(),
                                        [&](const StreamInfo& s) { return s.id.kind == id.kind; });
        return first != info_.streams.end() && first->id == id;
    }

    SetBuilder sets_;
    std::mutex tap_mutex_;
    FrameTap tap_;
    CompositeParts parts_;
    SourceInfo info_;
    std::unique_ptr<Controls> controls_;
};

}  // namespace

Result<std::unique_ptr<Source>> make_live_composite(CompositeParts parts,
                                                    const SetBuilderOptions& options) {
    auto source = std::make_unique<LiveComposite>(std::move(parts), options);
    if (!source->listen()) {
        return fail("cannot hear the frames of both as they come", source->info().uri);
    }
    return source;
}

}  // namespace kino
