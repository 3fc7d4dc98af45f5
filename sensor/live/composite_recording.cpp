#include <utility>

#include "sensor/live/composite_parts.h"
#include "sensor/pairing.h"

namespace kino {
namespace {

/// Walks along the depth recording and fetches from the other what belongs to each frame.
class RecordedComposite final : public Source {
  public:
    explicit RecordedComposite(CompositeParts parts)
        : parts_(std::move(parts)), info_(parts_.info()) {
        const Timeline& timeline = *parts_.color->timeline();
        color_times_.resize(static_cast<std::size_t>(timeline.frame_count()));
        for (std::size_t i = 0; i < color_times_.size(); ++i) {
            color_times_[i] = timeline.time_of(static_cast<std::int64_t>(i));
        }
        limit_ = pairing_limit(color_times_);
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return parts_.calibration(); }
    Timeline* timeline() override { return parts_.depth->timeline(); }

    Result<void> subscribe(StreamId id) override {
        KINO_TRY(parts_.of(id.kind).subscribe(id));
        if (id.kind == StreamKind::color) color_on_ = true;
        return {};
    }
    void unsubscribe(StreamId id) override {
        parts_.of(id.kind).unsubscribe(id);
        if (id.kind == StreamKind::color) color_on_ = false;
        fetched_.reset();
    }

    Result<std::optional<FrameSet>> next(TimeNs timeout) override {
        KINO_ASSIGN(std::optional<FrameSet> set, parts_.depth->next(timeout));
        if (!set || !color_on_) return set;
        const TimeNs time = timeline()->time_of(set->index);
        const auto pairing = pair_in_time(color_times_, time, limit_);
        if (!pairing) return set;
        KINO_ASSIGN(set->color, fetch(static_cast<std::int64_t>(pairing->index)));
        set->color_paired = pairing->paired;
        return set;
    }

    std::vector<Event> take_events() override {
        (void)parts_.color->take_events();
        return parts_.depth->take_events();
    }

  private:
    /// The same colour frame often serves twice running.
    Result<std::shared_ptr<const ColorFrame>> fetch(std::int64_t index) {
        if (fetched_ && fetched_index_ == index) return fetched_;
        KINO_TRY(parts_.color->timeline()->seek(index));
        KINO_ASSIGN(const std::optional<FrameSet> set, parts_.color->next(0));
        fetched_ = set ? set->color : nullptr;
        fetched_index_ = index;
        return fetched_;
    }

    CompositeParts parts_;
    SourceInfo info_;
    std::vector<TimeNs> color_times_;
    TimeNs limit_ = 0;
    bool color_on_ = false;
    std::shared_ptr<const ColorFrame> fetched_;
    std::int64_t fetched_index_ = -1;
};

}  // namespace

std::unique_ptr<Source> make_recorded_composite(CompositeParts parts) {
    return std::make_unique<RecordedComposite>(std::move(parts));
}

}  // namespace kino
