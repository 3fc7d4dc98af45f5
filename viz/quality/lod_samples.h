#pragma once

#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/lod_shared.h"
#include "viz/surface/sample_surface.h"

namespace kino {

/// Lists the pixels that show more than one surface: those whose samples are not all of one
/// triangle, and of which one differs from the surface at the centre by its object, by more than 2
/// sigma_z across the centre's plane, or by more than 2 sigma_n (infinite: does not count). At most
/// `share` of the picture, in the order of rows; where there are more, those whose colours differ
/// most. `surface` is the picture's with one sample: view_z, normal, albedo, object. Seven small
/// passes, "edges/...".
[[nodiscard]] LodFixList add_edge_list(graph::FrameGraph& graph, const SampleTargets& samples,
                                       const SurfaceTargets& surface, const View& view,
                                       const FramebufferLodOptions& options, float share);

/// What Eq. 1 needs (lod_eq1.glsl) where the picture that light is taken from is the fine one.
[[nodiscard]] shared::LodParams fine_eq1_params(const View& view,
                                                const FramebufferLodOptions& options);

}  // namespace kino
