#include "apps/viewer/frame_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kino {
namespace {

/// Late is what a person could see; a twentieth over is noise.
constexpr double kLate = 1.05;
/// So late is no hiccup, where all groups of that frame tell the same.
constexpr double kVeryLate = 1.5;
/// This share of the frames is to be on time. A choice fills the target as far as recent
/// predictions held for as many, within bounds.
constexpr double kOnTimeShare = 0.95;
constexpr double kLeastHeadroom = 0.75;
constexpr double kMostHeadroom = 0.92;
constexpr int kLateFrames = 2;
/// Zoom and the way of resizing are seen to change.
constexpr int kCalmFrames = 20;
constexpr int kSmallCalmFrames = 3;
constexpr double kSmallStep = 0.2;
/// In mean FLIP, beyond what it loses: light is made coarser rather than the picture.
constexpr double kZoomIsSeen = 0.01;
/// Counted work that changes by so much from one frame to the next is a jump, and the picture is
/// another, too; work that jumps all the time is none.
constexpr double kJump = 1.25;
constexpr int kBetweenJumps = 10;
/// A cheaper level must save this share of the frame; the one in use is kept while it saves less.
constexpr double kPays = 0.04;
constexpr double kStillPays = 0.01;
/// Where not even that reaches the target, so much of the frame must be saved for each unit of mean
/// FLIP that is lost: a picture that is late all the same need not be ugly as well.
constexpr double kWorth = 5;
/// Every so often all groups are measured at once, which costs a fence each.
constexpr std::int64_t kFullMeasure = 32;
/// After a change of the level memory is made anew, and the first time pipelines are.
constexpr int kUnsettled = 1;
/// Beyond the longest of the last frames.
constexpr double kBeginEarly = 1.1;
constexpr const char* kPart = "picture";

GovernorOptions governor_options(const FrameBudgetOptions& options) {
    return {.mode = GovernorMode::automatic,
            .target_ms = options.target_ms,
            .headroom = kLate / Surprises().quantile(kOnTimeShare),
            .late_frames = 1,
            .calm_frames = kCalmFrames,
            .late_above = kLate,
            .small_step = kSmallStep,
            .small_calm_frames = kSmallCalmFrames,
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

double FrameBudget::headroom() const {
    return std::clamp(kLate / surprises_.quantile(kOnTimeShare), kLeastHeadroom, kMostHeadroom);
}

bool FrameBudget::jumped(const PictureWork& before) const {
    const auto far = [](double a, double b) {
        return std::max(a, b) > kJump * std::max(1e-9, std::min(a, b));
    };
    return far(before.lights, work_.lights) || far(1000 + before.triangles, 1000 + work_.triangles);
}

bool FrameBudget::pays(std::size_t level, double ms, double better_ms, double better_error) const {
    const bool in_use = level == level_;
    if (!(ms < (1 - (in_use ? kStillPays : kPays)) * better_ms)) return false;
    const double reach_ms = (in_use ? kLate : headroom()) * options_.target_ms;
    if (ms <= reach_ms) return true;
    const double worth = (in_use ? 0.7 : 1) * kWorth;
    return better_ms - ms >= worth * (levels_[level].error - better_error) * better_ms;
}

void FrameBudget::choose(const Scene& scene, const View& view) {
    const bool staged = wants_stage(scene);
    const glm::ivec2 size(view.width, view.height);
    const PictureWork before = std::exchange(work_, count_work(scene, view));
    if (levels_.empty() || staged != staged_) {
        levels_ = picture_levels(staged, options_.most_zoom);
        // The best loses nothing, so something is left.
        std::erase_if(levels_, [this](const PictureLevel& level) {
            return level.error > std::max(0.0, options_.worst_error);
        });
        level_ = 0;
    }
    if (size != size_ || staged != staged_) {
        cost_ = PictureCost();
        surprises_.forget();
        knew_groups_ = false;
    }
    staged_ = staged;
    size_ = size;

    PartOffer part{.name = kPart, .levels = {}, .first_ms_per_work = 1};
    double least_ms = 0, least_error = 0;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        const PictureLevel& level = levels_[i];
        double ms = cost_.ms(level, size, work_);
        if (i == 0 || pays(i, ms, least_ms, least_error)) {
            least_ms = ms;
            least_error = level.error;
        } else {
            // Offered at the price of the better level, so nobody takes it.
            ms = std::max(ms, least_ms);
        }
        const bool bilinear = level.reconstruction == Reconstruction::bilinear;
        part.levels.push_back({.name = level.name(),
                               .work = ms,
                               .error = level.error + (level.zoom > 1 ? kZoomIsSeen : 0),
                               .kind = 2 * level.zoom + (bilinear ? 1 : 0)});
    }
    const std::vector<PartOffer> wanted = {std::move(part)};
    // What is known at once is answered at once: other work than before, the first whole measure.
    const bool learnt = !knew_groups_ && cost_.knows_groups();
    knew_groups_ = cost_.knows_groups();
    const bool jump =
        ++frames_since_jump_ > kBetweenJumps && cost_.knows_groups() && jumped(before);
    if (jump) frames_since_jump_ = 0;
    governor_.set_headroom(headroom());
    const std::size_t chosen = governor_.begin_frame(wanted, learnt || jump)[0];
    if (chosen != level_) frames_since_change_ = late_in_a_row_ = 0;
    level_ = chosen;
    take(levels_[level_]);
    choice_.predicted_ms = cost_.ms(levels_[level_], size, work_);
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
        level.error = picture_error(level);
        take(level);
    } else if (options_.mode == GovernorMode::automatic) {
        choose(scene, view);
        const bool wants_all = !cost_.knows_groups() || late_in_a_row_ > 0 ||
                               frames_since_change_ <= kUnsettled || frame_ % kFullMeasure == 0;
        if (frame.timing == graph::Timing::frame || wants_all) {
            frame.timing = wants_all ? graph::Timing::every_group : graph::Timing::one_group;
        }
    } else if (options_.mode == GovernorMode::fixed) {
        PictureLevel level{.lod = options_.lod, .zoom = options_.zoom};
        level.error = picture_error(level);
        take(level);
    } else {
        take({});
        note();
        ++frame_;
        return choice_;
    }
    frame.lod.reset();
    // Where LOD comes and goes, several samples take the light that is there at 1, too: shaded ones
    // cost four times as much.
    const bool varies = replays_ || options_.mode == GovernorMode::automatic;
    if (choice_.lod > 1 || (varies && frame.samples > 1)) {
        frame.lod = FramebufferLodOptions{.r = choice_.lod,
                                          .least_r = varies ? kLeastResizing : 0,
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
    if (std::isfinite(frame_ms)) recent_ms_[recent_++ % recent_ms_.size()] = frame_ms;
    if (replays_ || options_.mode != GovernorMode::automatic || levels_.empty()) return;
    const bool unsettled = ++frames_since_change_ <= kUnsettled;
    says_nothing = says_nothing || unsettled || !std::isfinite(frame_ms);
    if (!says_nothing) {
        late_in_a_row_ = frame_ms > kLate * options_.target_ms ? late_in_a_row_ + 1 : 0;
        const auto& groups = result.report.groups;
        const bool told_all = std::all_of(groups.begin(), groups.end(),
                                          [](const graph::GroupTime& g) { return g.ms >= 0; });
        // Late once is a hiccup. Late twice is none, and the next choice should know what this
        // frame says.
        const bool is_clear =
            late_in_a_row_ >= kLateFrames ||
            (told_all && !groups.empty() && frame_ms > kVeryLate * options_.target_ms);
        surprises_.add(choice_.predicted_ms, frame_ms);
        cost_.learn(levels_[level_], size_, work_, groups, frame_ms,
                    is_clear && late_in_a_row_ <= kLateFrames);
        says_nothing = late_in_a_row_ > 0 && !is_clear;
    }
    governor_.frame_took(frame_ms, says_nothing);
}

double FrameBudget::expected_ms() const {
    if (recent_ == 0) return options_.target_ms;
    return kBeginEarly * *std::max_element(recent_ms_.begin(), recent_ms_.end());
}

std::vector<PictureCost::Part> FrameBudget::parts() const {
    if (levels_.empty() || options_.mode != GovernorMode::automatic) return {};
    return cost_.parts(levels_[level_], size_, work_);
}

}  // namespace kino
