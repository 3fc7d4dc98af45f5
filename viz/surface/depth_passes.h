#pragma once

#include "viz/graph/graph.h"
#include "viz/surface/depth_bounds.h"
#include "viz/surface/depth_rasterizer.h"
#include "viz/surface/surface_shared.h"

namespace kino {

/// What every way of drawing a depth frame reads.
struct DepthPassInputs {
    shared::SurfaceParams params;
    graph::BufferId depth;
    graph::BufferId rays;
    graph::BufferId color;    ///< `depth` again where there is none
    graph::BufferId normals;  ///< invalid unless normals are wanted
    bool has_color = false;
    bool pinhole = false;  ///< params.depth_k says what `rays` would
    DepthBounds bounds;    ///< readings lie in here; never empty
    VkRect2D picture{};    ///< and are drawn in here
};

/// Index of the specialisation constant kPinhole (viz/surface/depth_grid.glsl).
constexpr std::size_t kPinholeConstant = 9;

/// A normal for every depth pixel, packed octahedral, view space.
[[nodiscard]] graph::BufferId add_normals_pass(graph::FrameGraph& graph,
                                               const DepthPassInputs& inputs);

/// Each adds one path's passes and returns the targets' new ids.
[[nodiscard]] SurfaceTargets add_compute_cloud(graph::FrameGraph& graph,
                                               const DepthPassInputs& inputs, bool key32,
                                               SurfaceTargets targets);
[[nodiscard]] SurfaceTargets add_compute_mesh(graph::FrameGraph& graph,
                                              const DepthPassInputs& inputs, bool key32,
                                              SurfaceTargets targets);
[[nodiscard]] SurfaceTargets add_hardware_points(graph::FrameGraph& graph,
                                                 const DepthPassInputs& inputs,
                                                 SurfaceTargets targets);
[[nodiscard]] SurfaceTargets add_hardware_mesh(graph::FrameGraph& graph,
                                               const DepthPassInputs& inputs,
                                               graph::BufferId indices, SurfaceTargets targets);

/// Fills the targets with "nothing there": a gradient between two packed sRGB colours, and no
/// depth, normal or id.
[[nodiscard]] SurfaceTargets add_background(graph::FrameGraph& graph, SurfaceTargets targets,
                                            std::uint32_t top, std::uint32_t bottom);

/// Draws the same into the pass's own targets, outside of `rect` alone; begin_targets() came
/// before.
void record_background_around(graph::PassContext& context, const SurfaceTargets& targets,
                              const shared::SurfaceParams& params, VkRect2D rect);

/// Declares the wanted targets as colour attachments of `builder`'s pass.
void write_targets(graph::PassBuilder& builder, SurfaceTargets& targets);
/// Attachment formats in output order; targets nobody wants are UNDEFINED.
[[nodiscard]] std::vector<VkFormat> target_formats(const graph::PassContext& context,
                                                   const SurfaceTargets& targets);
/// Starts rendering into the wanted targets, cleared to "nothing there" where asked.
void begin_targets(graph::PassContext& context, const SurfaceTargets& targets, bool clear,
                   const gpu::Target* depth);

}  // namespace kino
