#include "apps/viewer/zoom_chooser.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>
#include <string_view>
#include <utility>

namespace kino {
namespace {

/// Share of the target that a choice may fill: times scatter.
constexpr double kFill = 0.95;
/// Of a frame, that a zoom must save to be taken: a picture is not made coarser for nothing.
constexpr double kLeastSaving = 0.1;
constexpr double kLate = 1.05;
/// After a change of z memory is made anew, and the first time pipelines are.
constexpr std::int64_t kUnsettled = 1;
constexpr int kCalibration = 4;
/// Every so often all groups are measured at once, which costs a fence each.
constexpr std::int64_t kFullMeasure = 32;
/// Costs before anything like it was drawn: of a pixel, and as parts of that of one with a surface,
/// of one light's lobe on it, and of one light's shadow.
constexpr double kPixelMs = 1e-5;
constexpr std::array kOfPixel = {1.0, 1.0, 0.5, 2.0};
/// A group's measurements are of one load where they differ by less, and were made so many frames
/// before a change of z at most.
constexpr double kAlike = 0.25;
constexpr std::int64_t kJustBefore = 3, kBefore = 16;
constexpr int kPoints = 6;
/// Enlarging before it was ever measured, docs/accuracy/zoom.md, ns a pixel.
constexpr double kCopyNs = 2;
/// One frame that takes more than this many times what was expected may be a hiccup.
constexpr double kSurprise = 2;
/// A view that moves by more from one picture to the next did not move: it was put elsewhere.
constexpr double kJumpM = 1, kJumpDeg = 45;

bool goes_with_pixels(std::string_view group) {
    static const std::set<std::string_view> kGroups = {
        "raster", "normals", "final", "cull", "light", "shadows", "lod", "skeleton", "debug"};
    return kGroups.count(group) > 0;
}

double degrees_between(const glm::dquat& a, const glm::dquat& b) {
    const double cosine = std::min(1.0, std::abs(glm::dot(a, b)));
    return glm::degrees(2 * std::acos(cosine));
}

}  // namespace

const char* zoom_by_name(SceneZoomBy by) {
    switch (by) {
        case SceneZoomBy::fixed:
            return "fixed";
        case SceneZoomBy::reactive:
            return "reactive";
        case SceneZoomBy::predictive:
            return "predictive";
        case SceneZoomBy::head:
            return "head";
    }
    return "unknown";
}

double ZoomChooser::Group::ms_at(int zoom) const {
    const auto share = [&](int at) { return 1 - part + part / (at * at); };
    return ms * share(zoom) / share(z);
}

void ZoomChooser::Group::measured(double new_ms, int zoom, std::int64_t now) {
    const bool alike = std::abs(new_ms - mean_ms) <= kAlike * mean_ms;
    if (zoom != z) {
        // Up it goes where a load came, so only what was measured just before is of that load.
        then_ms = now - frame <= (zoom > z ? kJustBefore : kBefore) ? mean_ms : -1;
        then_z = z;
        part_then = part;
        points = 0;
    } else if (!alike) {
        then_ms = -1;
        points = 0;
    }
    points = std::min(points + 1, kPoints);
    mean_ms = points == 1 ? new_ms : mean_ms + (new_ms - mean_ms) / points;
    ms = new_ms;
    z = zoom;
    frame = now;
    if (then_ms < 0) return;
    const double u = 1.0 / (z * z), then_u = 1.0 / (then_z * then_z);
    const double slope = std::max(0.0, (then_ms - mean_ms) / (then_u - u));
    const double offset = std::max(0.0, mean_ms - slope * u);
    if (!(slope + offset > 0)) return;
    const double line = slope / (slope + offset);
    part = part_known ? 0.5 * (part_then + line) : line;
    if (points < kPoints) return;
    part_known = true;
    then_ms = -1;
}

ZoomRules ZoomChooser::rules() const {
    return {.target_ms = kFill * options_.target_ms,
            .most = std::clamp(options_.most, 1, kMaxZoom),
            .least_saving = kLeastSaving};
}

void ZoomChooser::set(const ZoomChooserOptions& options) {
    options_ = options;
    choice_ = {};
    predicted_ms_ = 0;
    frames_ = since_change_ = 0;
    late_in_a_row_ = calibrated_ = 0;
    size_.reset();
    groups_.clear();
    rest_ms_ = copy_ms_ = -1;
    start_ = {};
    was_surprised_ = false;
    reactive_.reset();
    predictive_.reset();
    head_.reset();
    last_view_.reset();
    if (options_.by == SceneZoomBy::reactive) reactive_.emplace(rules());
    if (options_.by == SceneZoomBy::head) {
        head_.emplace(HeadSpeedOptions{.most = std::clamp(options_.most, 1, kMaxZoom)});
    }
}

void ZoomChooser::set_target(double ms) {
    if (!std::isfinite(ms) || ms <= 0 || ms == options_.target_ms) return;
    ZoomChooserOptions options = options_;
    options.target_ms = ms;
    set(options);
}

double ZoomChooser::enlarging_ms() const {
    if (copy_ms_ >= 0 || !size_) return std::max(0.0, copy_ms_);
    return 1e-6 * kCopyNs * static_cast<double>(size_->x) * size_->y;
}

int ZoomChooser::step_head(const View& view, TimeNs now,
                           const std::optional<glm::dvec3>& head_m_s) {
    const double dt_s = last_view_ ? to_seconds(now - last_time_) : 0;
    glm::dvec3 velocity_m_s = head_m_s.value_or(glm::dvec3(0));
    double turn_deg_s = 0;
    if (!head_m_s && last_view_ && dt_s > 0) {
        const glm::dvec3 way_m =
            view.world_from_view.translation - last_view_->world_from_view.translation;
        const double turn_deg =
            degrees_between(view.world_from_view.rotation, last_view_->world_from_view.rotation);
        if (glm::length(way_m) < kJumpM && turn_deg < kJumpDeg) {
            velocity_m_s = way_m / dt_s;
            turn_deg_s = turn_deg / dt_s;
        }
    }
    last_view_ = view;
    last_time_ = now;
    return head_->step(dt_s, velocity_m_s, turn_deg_s);
}

int ZoomChooser::begin_frame(const Scene& scene, const View& view, TimeNs now,
                             const std::optional<glm::dvec3>& head_m_s, FrameOptions& frame) {
    if (!on()) return 1;
    const glm::ivec2 size(view.width, view.height);
    if (size_ != size && size_) set(ZoomChooserOptions(options_));
    size_ = size;
    const int before = choice_.z;
    if (head_) {
        choice_ = {.z = step_head(view, now, head_m_s)};
    } else if (options_.by == SceneZoomBy::predictive) {
        work_ = counter_.count(scene, view);
        if (predictive_) {
            choice_ = predictive_->choose(work_.counted());
            predicted_ms_ = predictive_->predict_ms(work_.counted(), choice_.z);
        }
    } else {
        choice_ = reactive_->choice();
    }
    since_change_ = choice_.z == before ? since_change_ + 1 : 0;
    frame.zoom.z = choice_.z;
    if (!head_) {
        const bool wants_all = frames_ <= kCalibration || late_in_a_row_ > 0 ||
                               since_change_ <= kUnsettled || frames_ % kFullMeasure == 0;
        if (frame.timing == graph::Timing::frame || wants_all) {
            frame.timing = wants_all ? graph::Timing::every_group : graph::Timing::one_group;
        }
    }
    return choice_.z;
}

void ZoomChooser::react(const FrameResult& result, double frame_ms) {
    std::map<std::string_view, int> occurrences;
    double pixels_ms = 0, all_ms = 0;
    bool all_measured = true;
    for (const graph::GroupTime& time : result.report.groups) {
        const bool measured = std::isfinite(time.ms) && time.ms >= 0;
        all_measured = all_measured && measured;
        if (time.group == "zoom") {
            if (measured) copy_ms_ = time.ms;
            all_ms += enlarging_ms();
            continue;
        }
        const std::string key = fmt::format("{}#{}", time.group, occurrences[time.group]++);
        const auto known = groups_.find(key);
        if (known == groups_.end() && !measured) continue;
        Group& group = known != groups_.end() ? known->second : groups_[key];
        if (known == groups_.end()) {
            // Of meshes nobody knows before the first change of z.
            const bool meshes = time.group == "meshes";
            group = {.ms = time.ms,
                     .z = choice_.z,
                     .part = meshes                         ? 0.5
                             : goes_with_pixels(time.group) ? 1.0
                                                            : 0.0,
                     .part_known = !meshes,
                     .mean_ms = time.ms,
                     .points = 1,
                     .frame = frames_};
        } else if (measured) {
            group.measured(time.ms, choice_.z, frames_);
        }
        const double share = 1 - group.part + group.part / (choice_.z * choice_.z);
        all_ms += group.ms_at(choice_.z);
        pixels_ms += group.ms_at(choice_.z) * (share - (1 - group.part)) / share;
    }
    if (all_measured || rest_ms_ < 0) rest_ms_ = std::max(0.0, frame_ms - all_ms);
    const double known_ms = all_ms + rest_ms_;
    if (!(known_ms > 0)) return;
    // A frame that takes longer than its groups last did is taken to be longer in all of them.
    reactive_->frame_took(frame_ms, frame_ms * pixels_ms / known_ms, enlarging_ms());
}

void ZoomChooser::calibrate(const FrameResult& result, double frame_ms) {
    // The quickest of a few frames: pipelines and caches are still being filled.
    if (calibrated_ == 0) {
        start_.frame = 0;
        start_.pixel = {0, 0, 0, 0};
    }
    const auto least = [](double& cost, double ms, double work) {
        if (!(work > 0)) return;
        const double now = std::max(1e-12, ms / work);
        cost = cost > 0 ? std::min(cost, now) : now;
    };
    double rest = frame_ms, light = 0, picture = 0, shadows = 0;
    for (const graph::GroupTime& time : result.report.groups) {
        if (!(time.ms >= 0)) continue;
        rest -= time.ms;
        if (time.group == "light") light += time.ms;
        if (time.group == "shadows") shadows += time.ms;
        const ZoomWork own = work_.of_group(time.group);
        if (own.pixels[0] > 0) picture += time.ms;
        if (time.group == "meshes") {
            // What triangles do not explain is the filling of pixels.
            const double counted = start_.vertex * own.vertices + start_.triangle * own.triangles +
                                   start_.draw * own.draws;
            const double shrink = counted > 0 ? std::clamp(0.5 * time.ms / counted, 1e-3, 1.0) : 1;
            start_.vertex *= shrink, start_.triangle *= shrink, start_.draw *= shrink;
        }
    }
    least(start_.frame, std::max(0.1, rest), 1);
    least(start_.pixel[0], picture, work_.pixels);
    least(start_.pixel[1], 0.3 * light, work_.covered);
    least(start_.pixel[2], 0.7 * light, work_.lobes);
    least(start_.pixel[3], shadows, work_.shadowed);
    if (++calibrated_ < kCalibration) return;
    start_.copy = std::max(1e-3, enlarging_ms());
    // What was not there in these frames is guessed from what a pixel takes here.
    const double pixel = start_.pixel[0] > 0 ? start_.pixel[0] : kPixelMs;
    for (std::size_t i = 0; i < start_.pixel.size(); ++i) {
        if (!(start_.pixel[i] > 0)) start_.pixel[i] = kOfPixel[i] * pixel;
    }
    predictive_.emplace(rules(), start_);
}

void ZoomChooser::learn(const FrameResult& result, double frame_ms) {
    if (!predictive_) return calibrate(result, frame_ms);
    const bool hiccup = predicted_ms_ > 0 && frame_ms > kSurprise * predicted_ms_;
    const bool again = std::exchange(was_surprised_, hiccup);
    predictive_->frame_took(hiccup && !again ? kSurprise * predicted_ms_ : frame_ms);
    std::map<std::string_view, double> measured;
    std::set<std::string_view> partly;
    for (const graph::GroupTime& time : result.report.groups) {
        if (time.group == "zoom" && time.ms >= 0) predictive_->copy_took(copy_ms_ = time.ms);
        measured[time.group] += std::max(0.0, time.ms);
        if (!(time.ms >= 0)) partly.insert(time.group);
    }
    if (hiccup && !again) return;
    for (const auto& [group, ms] : measured) {
        if (partly.count(group) == 0) {
            predictive_->part_took(work_.of_group(group), choice_.z, ms);
        }
    }
}

void ZoomChooser::frame_took(const FrameResult& result, double frame_ms, bool says_nothing) {
    if (!on() || head_ || says_nothing || !std::isfinite(frame_ms) || frame_ms < 0) return;
    ++frames_;
    late_in_a_row_ = frame_ms > kLate * options_.target_ms ? late_in_a_row_ + 1 : 0;
    if (since_change_ < kUnsettled && frames_ > 1) return;
    if (reactive_) {
        react(result, frame_ms);
    } else {
        learn(result, frame_ms);
    }
}

std::string ZoomChooser::words() const {
    std::string text = choice_.z > 1 ? fmt::format("1/{}", choice_.z) : "full";
    if (predicted_ms_ > 0) {
        text += fmt::format(", {:.1f} ms of {:.0f} expected", predicted_ms_, options_.target_ms);
    } else if (options_.by == SceneZoomBy::predictive) {
        text += ", calibrating";
    }
    if (choice_.unreachable) text += ", out of reach";
    return text;
}

}  // namespace kino
