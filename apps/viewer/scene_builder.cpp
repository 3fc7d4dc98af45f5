#include "apps/viewer/scene_builder.h"

namespace kino {

void SceneBuilder::show(const ProcessedFrame& frame) {
    if (!frame.surface) {
        scene_.live.reset();
        scene_.bodies.clear();
        return;
    }
    if (!place_) {
        place_ = measure_place(frame);
        scene_.live.reset();
    }
    has_color_ = !frame.surface->color.empty();
    const Pose previous = scene_.live ? scene_.live->world_from_depth : frame.set.world_from_depth;
    scene_.live = LiveDepth{.surface = frame.surface,
                            .world_from_depth = frame.set.world_from_depth,
                            .previous_world_from_depth = previous};
    scene_.bodies.clear();
    if (!frame.set.bodies) return;
    for (const Body& body : frame.set.bodies->bodies) {
        scene_.bodies.push_back(
            {.id = body.id, .body = body, .world_from_depth = frame.set.world_from_depth});
    }
}

ColorMode SceneBuilder::color_mode(const DrawOptions& options) const {
    return options.color.value_or(has_color_ ? ColorMode::captured : ColorMode::relit);
}

const Scene& SceneBuilder::scene(const DrawOptions& options) {
    ++scene_.frame_index;
    scene_.color_mode = color_mode(options);
    if (scene_.live) {
        scene_.live->style = options.style;
        scene_.live->splat_cap_px = options.splat_px;
    }
    // Lights that change nothing are not called for.
    if (scene_.color_mode == ColorMode::captured || !place_) {
        scene_.lights.clear();
    } else {
        scene_.lights = studio_lights(*place_);
    }
    return scene_;
}

}  // namespace kino
