#pragma once

#include <array>
#include <glm/vec4.hpp>
#include <span>
#include <string>

#include "viz/graph/executor.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/scene/view.h"

namespace kino {

/// Width of the tiles that are flat or not, fine pixels.
constexpr int kLodTilePx = 16;

/// 1/fx, 1/fy, cx, cy.
[[nodiscard]] glm::vec4 lod_ray_scale(const View& view);
/// coarse = fine * xy + zw, pixels, centres at integers.
[[nodiscard]] glm::vec4 lod_coarse_of_fine(const View& fine, const View& coarse);

/// Lists the doubtful pixels (`doubt`: R8, lod_fix_shared.h) of a picture of the view's size.
[[nodiscard]] LodFixList add_fix_list(graph::FrameGraph& graph, graph::TextureId doubt,
                                      const View& view, const FramebufferLodOptions& options);

/// The list itself: pixels whose number in `rank` (R8, whole numbers to 63) is at least `least`, at
/// most this share of the picture, the highest first. `name` is what its six passes begin with.
[[nodiscard]] LodFixList add_pixel_list(graph::FrameGraph& graph, const std::string& name,
                                        graph::TextureId rank, const View& view, float share,
                                        std::uint32_t least);

}  // namespace kino
