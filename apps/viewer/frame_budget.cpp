#include "apps/viewer/frame_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kino {
namespace {

/// Late is what a person could see; a twentieth over is noise.
constexpr double kLate = 1.05;
/// Share of the target that a choice may fill: times scatter by about a tenth.
constexpr double kHeadroom = 0.9;
constexpr int kLateFrames = 2;
constexpr int kCalmFrames = 30;
/// A cheaper level must save this share of the frame; the one in use is kept while it saves less.
constexpr double kPays = 0.05;
constexpr double kStillPays = 0.01;
/// Where not even that reaches the target, so much of the frame must be saved for each unit of mean
/// FLIP that is lost: a picture that is late all the same need not be ugly as well.
constexpr double kWorth = 5;
/// Every so often all groups are measured at once, which costs a fence each.
constexpr std::int64_t kFullMeasure = 32;
/// After a change of the level memory is made anew, and the first time pipelines are.
constexpr int kUnsettled = 1;
constexpr const char* kPart = "picture";

GovernorOptions governor_options(const FrameBudgetOptions& options) {
    return {.mode = GovernorMode::automatic,
            .target_ms = options.target_ms,
            .headroom = kHeadroom,
            .late_frames = kLateFrames,
            .calm_frames = kCalmFrames,
            .late_above = kLate,
            .learns = false};
}

}  // namespace

FrameBudget::FrameBudget(const FrameBudgetOptions& options)
    : options_(options), governor_(governor_options(options)) {}

void FrameBudget::set_target(double ms) {
    if (!std::isfinite(ms) || ms <= 0) return;
    options_.target_ms = ms;
    governor_.set_target(ms);
}

void FrameBudget::replay(std::vector<Logged> log) {
    replayed_ = std::move(log);
    std::stable_sort(replayed_.begin(), replayed_.end(),
                     [](const Logged& a, const Logged& b) { return a.frame < b.frame; });
    replays_ = true;
    frame_ = 0;
    log_.clear();
}

void FrameBudget::take(const PictureLevel& level) {
    choice_.lod = level.lod;
    choice_.zoom = level.zoom;
    choice_.bilinear = level.lod > 1 && level.reconstruction == Reconstruction::bilinear;
    choice_.levels.clear();
    if (level.lod > 1 || level.zoom > 1) choice_.levels.push_back(level.name());
    choice_.estimated_error = level.error;
    choice_.predicted_ms = 0;
}

void FrameBudget::note() {
    const Logged now{
        .frame = frame_, .lod = choice_.lod, .zoom = choice_.zoom, .bilinear = choice_.bilinear};
    if (!log_.empty()) {
        const Logged& last = log_.back();
        if (last.lod == now.lod && last.zoom == now.zoom && last.bilinear == now.bilinear) return;
    }
    log_.push_back(now);
}

bool FrameBudget::pays(std::size_t level, double ms, double better_ms, double better_error) const {
    const bool in_use = level == level_;
    if (!(ms < (1 - (in_use ? kStillPays : kPays)) * better_ms)) return false;
    const double reach_ms = (in_use ? kLate : kHeadroom) * options_.target_ms;
    if (ms <= reach_ms) return true;
    const double worth = (in_use ? 0.7 : 1) * kWorth;
    return better_ms - ms >= worth * (levels_[level].error - better_error) * better_ms;
}

void FrameBudget::choose(const Scene& scene, const View& view) {
    const bool staged = wants_stage(scene);
    const glm::ivec2 size(view.width, view.height);
    if (levels_.empty() || staged != staged_) {
        levels_ = picture_levels(staged, options_.most_zoom);
        // The best loses nothing, so something is left.
        std::erase_if(levels_, [this](const PictureLevel& level) {
            return level.error > std::max(0.0, options_.worst_error);
        });
        level_ = 0;
    }
    if (size != size_ || staged != staged_) cost_ = PictureCost();
    staged_ = staged;
    size_ = size;

    PartOffer part{.name = kPart, .levels = {}, .first_ms_per_work = 1};
    double least_ms = 0, least_error = 0;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const PictureLevel& level = levels_[i];
        double ms = cost_.ms(level, size);
        if (i == 0 || pays(i, ms, least_ms, least_error)) {
            least_ms = ms;
            least_error = level.error;
        } else {
            // Offered at the price of the better level, so nobody takes it.
            ms = std::max(ms, least_ms);
        }
        part.levels.push_back({level.name(), ms, level.error});
    }
    const std::vector<PartOffer> wanted = {std::move(part)};
    const std::size_t chosen = governor_.begin_frame(wanted)[0];
    if (chosen != level_) frames_since_change_ = late_in_a_row_ = 0;
    level_ = chosen;
    take(levels_[level_]);
    choice_.predicted_ms = cost_.ms(levels_[level_], size);
}

const FrameChoice& FrameBudget::begin_frame(const Scene& scene, const View& view,
                                            FrameOptions& frame) {
    if (replays_) {
        PictureLevel level;
        for (const Logged& line : replayed_) {
            if (line.frame > frame_) break;
            level = {.lod = std::max(1.0, line.lod),
                     .reconstruction =
                         line.bilinear ? Reconstruction::bilinear : Reconstruction::geometry_aware,
                     .zoom = std::max(1, line.zoom)};
        }
        level.error = lod_error(level.lod, level.reconstruction) + zoom_error(level.zoom);
        take(level);
    } else if (options_.mode == GovernorMode::automatic) {
        choose(scene, view);
        const bool wants_all = !cost_.knows_groups() || late_in_a_row_ > 0 ||
                               frames_since_change_ <= kUnsettled || frame_ % kFullMeasure == 0;
        if (frame.timing == graph::Timing::frame || wants_all) {
            frame.timing = wants_all ? graph::Timing::every_group : graph::Timing::one_group;
        }
    } else if (options_.mode == GovernorMode::fixed) {
        take({.lod = options_.lod,
              .zoom = options_.zoom,
              .error = lod_error(options_.lod, Reconstruction::geometry_aware) +
                       zoom_error(options_.zoom)});
    } else {
        take({});
        note();
        ++frame_;
        return choice_;
    }
    frame.lod.reset();
    if (choice_.lod > 1) {
        frame.lod = FramebufferLodOptions{.r = choice_.lod,
                                          .fix_share = static_cast<float>(options_.fix_share)};
        if (choice_.bilinear) {
            frame.lod->reconstruction = Reconstruction::bilinear;
            frame.lod->fine_grained = false;
            frame.lod->fix_share = 0;
        }
    }
    frame.zoom.z = choice_.zoom;
    note();
    ++frame_;
    return choice_;
}

void FrameBudget::frame_took(const FrameResult& result, double frame_ms, bool says_nothing) {
    if (replays_ || options_.mode != GovernorMode::automatic || levels_.empty()) return;
    const bool unsettled = ++frames_since_change_ <= kUnsettled;
    if (!says_nothing && !unsettled && std::isfinite(frame_ms)) {
        late_in_a_row_ = frame_ms > kLate * options_.target_ms ? late_in_a_row_ + 1 : 0;
        // Late twice is no hiccup: the next choice should know what this frame says.
        cost_.learn(levels_[level_], size_, result.report.groups, frame_ms,
                    late_in_a_row_ == kLateFrames);
    }
    governor_.frame_took(frame_ms, says_nothing || unsettled);
}

std::vector<PictureCost::Part> FrameBudget::parts() const {
    if (levels_.empty() || options_.mode != GovernorMode::automatic) return {};
    return cost_.parts(levels_[level_], size_);
}

}  // namespace kino
