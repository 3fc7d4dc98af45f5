#include "apps/pipeline/body_stage.h"

#include <utility>

#include "sensor/file_bytes.h"
#include "skeleton/forest/default_forest.h"
#include "skeleton/forest/forest_file.h"

namespace kino {
namespace {

/// More frames at once than this are a jump.
constexpr std::int64_t kSkip = 30;
constexpr std::size_t kMostKnown = 4000;
constexpr std::size_t kMostDefinitionBytes = std::size_t{4} << 20;

Result<GestureDefinitions> read_definitions(const std::filesystem::path& path) {
    if (path.empty()) return GestureDefinitions{};
    KINO_ASSIGN(const std::string text, read_file_text(path, kMostDefinitionBytes));
    return gestures_from_json(text, path.string());
}

Result<std::shared_ptr<const Forest>> forest_of(const BodyOptions& options) {
    if (options.forest.empty()) return default_forest();
    KINO_ASSIGN(Forest forest, read_forest(options.forest));
    return std::make_shared<const Forest>(std::move(forest));
}

Result<BodyFinder> tracker_of(const BodyOptions& options, const Rig& rig) {
    BodyTrackerOptions tracking;
    tracking.mode = options.seated ? TrackingMode::seated : TrackingMode::full;
    tracking.people.moving_sensor = options.moving_sensor;
    if (!options.joint_filter.empty()) tracking.filter = options.joint_filter;
    KINO_ASSIGN(auto forest, forest_of(options));
    KINO_ASSIGN(BodyTracker made,
                BodyTracker::create(rig.depth_rays(), std::move(forest), tracking));
    auto tracker = std::make_shared<BodyTracker>(std::move(made));
    return BodyFinder([tracker](const Image<float>& depth_m, TimeNs time,
                                const std::optional<glm::vec3>& force, BodyFrame& out) {
        tracker->track(depth_m, time, force, out);
        return tracker->times();
    });
}

std::optional<glm::vec3> specific_force_of(const FrameSet& set) {
    if (!set.motion) return std::nullopt;
    const auto& a = set.motion->acceleration_m_s2;
    return glm::vec3(static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2]));
}

}  // namespace

const char* body_mode_name(BodyMode mode) {
    switch (mode) {
        case BodyMode::on:
            return "on";
        case BodyMode::recorded:
            return "recorded";
        case BodyMode::off:
            break;
    }
    return "off";
}

Result<std::unique_ptr<BodyStage>> BodyStage::create(const BodyOptions& options, const Rig& rig) {
    if (options.mode == BodyMode::off) return nullptr;
    KINO_ASSIGN(GestureDefinitions definitions, read_definitions(options.gestures));
    if (options.mode == BodyMode::recorded) {
        KINO_ASSIGN(FilterBank filter,
                    FilterBank::create(options.joint_filter.empty() ? std::string("none")
                                                                    : options.joint_filter));
        return std::make_unique<BodyStage>(nullptr, std::move(filter), std::move(definitions));
    }
    auto finder = tracker_of(options, rig);
    if (!finder) {
        return fail("bodies cannot be tracked: " + finder.error().what, finder.error().where,
                    finder.error().hint);
    }
    return std::make_unique<BodyStage>(std::move(*finder), std::nullopt, std::move(definitions));
}

BodyStage::BodyStage(BodyFinder finder, std::optional<FilterBank> filter,
                     GestureDefinitions definitions)
    : finder_(std::move(finder)), filter_(std::move(filter)), recognizer_(std::move(definitions)) {}

/// What this frame had when it came for the first time; null for a frame that is new, and after a
/// jump, which forgets everything.
const BodyStage::Known* BodyStage::known(std::int64_t index) {
    const std::int64_t step = index - std::exchange(last_index_, index);
    if (step > kSkip || step < -kSkip) known_.clear();
    if (known_.empty() || index > known_.rbegin()->first) return nullptr;
    const auto after = known_.upper_bound(index);
    if (after == known_.begin()) {
        known_.clear();
        return nullptr;
    }
    // A frame that was passed over shows the one before it.
    return &std::prev(after)->second;
}

void BodyStage::process(ProcessedFrame& frame) {
    const TimeNs began = now_ns();
    frame.gestures.clear();
    if (const Known* before = known(frame.set.index)) {
        frame.set.bodies = before->bodies;
        frame.primary_id = before->primary_id;
        frame.times.bodies = now_ns() - began;
        return;
    }
    auto bodies = std::make_shared<BodyFrame>();
    bodies->time = frame.set.time;
    if (!finder_) {
        if (frame.set.bodies)
            *bodies = filter_ ? filter_->update(*frame.set.bodies) : *frame.set.bodies;
    } else if (frame.surface) {
        frame.tracking =
            finder_(frame.surface->depth_m, frame.set.time, specific_force_of(frame.set), *bodies);
    }
    frame.gestures = recognizer_.update(*bodies);
    frame.primary_id = recognizer_.primary_id();
    frame.bodies_are_new = true;
    frame.set.bodies = std::move(bodies);
    known_[frame.set.index] = {frame.set.bodies, frame.primary_id};
    if (known_.size() > kMostKnown) known_.erase(known_.begin());
    frame.times.bodies = now_ns() - began;
}

}  // namespace kino
