#include "apps/viewer/scene_builder.h"

#include <glm/geometric.hpp>

#include "apps/stage/cutout.h"
#include "apps/stage/outline.h"

namespace kino {
namespace {

/// What makes an orbiting camera begin at `eye` and look at `target` (OrbitCamera::reset).
ScenePlace place_seen_from(const glm::dvec3& eye, const glm::dvec3& target) {
    constexpr double kOrbitOfPlace = 1.12;
    return {.center = target,
            .world_from_depth = {.rotation = world_from_camera_axes().rotation, .translation = eye},
            .distance_m = glm::distance(eye, target) / kOrbitOfPlace};
}

}  // namespace

void SceneBuilder::reset() {
    place_.reset();
    bodies_.reset();
    if (director_) director_->reset();
}

void SceneBuilder::show_cut_out(const ProcessedFrame& frame) {
    const SceneLive& live = director_->file().live;
    if (live.show == SceneShow::none) {
        scene_.live.reset();
    } else if (live.show == SceneShow::people && frame.set.bodies &&
               !frame.set.bodies->bodies.empty()) {
        std::optional<double> floor_y_m;
        if (director_->found_person()) floor_y_m = director_->world_from_stage()->translation.y;
        const int outline_px =
            live.smooth_outline ? outline_radius_px(frame.surface->depth_m.width()) : 0;
        scene_.live->surface = cut_out_people(*frame.surface, *frame.set.bodies, live.margin_m,
                                              frame.set.world_from_depth, floor_y_m, outline_px);
    }
}

bool SceneBuilder::advance(double dt_s) {
    if (!director_ || !place_) return false;
    const std::optional<Pose> before = director_->world_from_stage();
    director_->step({.dt_s = dt_s,
                     .bodies = bodies_.get(),
                     .world_from_depth = world_from_depth_,
                     .middle_m = middle_m_});
    if (before == director_->world_from_stage()) return false;
    place_ = place_seen_from(director_->eye_m(), director_->target_m());
    return true;
}

void SceneBuilder::show(const ProcessedFrame& frame) {
    if (!frame.surface) {
        scene_.live.reset();
        scene_.bodies.clear();
        bodies_.reset();
        return;
    }
    if (!place_) {
        place_ = measure_place(frame);
        middle_m_ = place_->center;
        scene_.live.reset();
    }
    has_color_ = !frame.surface->color.empty();
    const Pose previous = scene_.live ? scene_.live->world_from_depth : frame.set.world_from_depth;
    scene_.live = LiveDepth{.surface = frame.surface,
                            .world_from_depth = frame.set.world_from_depth,
                            .previous_world_from_depth = previous};
    bodies_ = frame.set.bodies;
    world_from_depth_ = frame.set.world_from_depth;
    if (director_) show_cut_out(frame);
    scene_.bodies.clear();
    if (!frame.set.bodies) return;
    for (const Body& body : frame.set.bodies->bodies) {
        scene_.bodies.push_back(
            {.id = body.id, .body = body, .world_from_depth = frame.set.world_from_depth});
    }
}

ColorMode SceneBuilder::color_mode(const DrawOptions& options) const {
    if (director_) return options.color.value_or(director_->file().color);
    return options.color.value_or(has_color_ ? ColorMode::captured : ColorMode::relit);
}

const Scene& SceneBuilder::scene(const DrawOptions& options) {
    ++scene_.frame_index;
    if (director_ && director_->world_from_stage()) director_->fill(scene_);
    scene_.color_mode = color_mode(options);
    if (scene_.live) {
        scene_.live->style = options.style;
        scene_.live->splat_cap_px = options.splat_px;
        scene_.live->casts_shadows = director_ && director_->file().live.casts_shadows;
    }
    if (director_) return scene_;
    // Lights that change nothing are not called for.
    if (scene_.color_mode == ColorMode::captured || !place_) {
        scene_.lights.clear();
    } else {
        scene_.lights = studio_lights(*place_);
    }
    return scene_;
}

}  // namespace kino
