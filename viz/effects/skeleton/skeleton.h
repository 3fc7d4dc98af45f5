#pragma once

#include <optional>
#include <vector>

#include "viz/effects/skeleton/skeleton_shared.h"
#include "viz/graph/executor.h"
#include "viz/graph/graph.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

/// The skeleton overlay: a sphere at every joint and a round bone to its parent. Tracked parts
/// are solid, inferred ones dashed, lost ones not drawn; what lies inside the body or behind
/// something is dimmed.
struct SkeletonRequest {
    std::vector<shared::CapsuleRecord> capsules;  ///< view space
};

/// One colour a person, by identity; sRGB.
[[nodiscard]] glm::vec3 person_color(std::uint32_t id);

/// Nothing where the scene has no body with a joint in front of the camera.
[[nodiscard]] std::optional<SkeletonRequest> skeleton_wanted(const Scene& scene, const View& view);

/// Draws over `target` (sRGB-coded); `view_z` is the surface's. Returns the target's new id.
[[nodiscard]] graph::TextureId add_skeleton(graph::FrameGraph& graph, const View& view,
                                            graph::TextureId target, graph::TextureId view_z,
                                            const SkeletonRequest& request);

}  // namespace kino
