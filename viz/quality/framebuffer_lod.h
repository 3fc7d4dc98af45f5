#pragma once

#include "viz/graph/graph.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// How a coarse picture is brought to full size (Yang, Sander, Lawrence, EGSR 2008).
enum class Reconstruction : std::uint8_t { bilinear, geometry_aware };
enum class RangeMetric : std::uint8_t { depth, log_depth, plane };

struct FramebufferLodOptions {
    double r = 2;  ///< resizing factor, at least 1
    Reconstruction reconstruction = Reconstruction::geometry_aware;
    RangeMetric metric = RangeMetric::plane;
    float sigma_z = 0.02f;  ///< relative; infinite: depth does not count
    float sigma_n = 0.25f;  ///< infinite: normals do not count
    /// Divide the coarse light by its albedo and multiply by the fine one (fine-grained resizing).
    bool fine_grained = true;
};

/// A coarse surface whose texels were picked from the fine one, and the view that fits it.
struct CoarseSurface {
    SurfaceTargets surface;
    View view;
};
[[nodiscard]] CoarseSurface add_coarse_surface(graph::FrameGraph& graph, const SurfaceTargets& fine,
                                               const View& view,
                                               const FramebufferLodOptions& options);

/// Brings `coarse_linear` (RGBA16F, shaded from `coarse`) to the size of the fine surface.
[[nodiscard]] graph::TextureId add_reconstruction(graph::FrameGraph& graph,
                                                  graph::TextureId coarse_linear,
                                                  const CoarseSurface& coarse,
                                                  const SurfaceTargets& fine, const View& view,
                                                  const FramebufferLodOptions& options);

}  // namespace kino
