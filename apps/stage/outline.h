#pragma once

#include "viz/scene/scene.h"

namespace kino {

/// Radius for cut-outs of a sensor's picture: its edges are ragged by about as much.
[[nodiscard]] int outline_radius_px(int picture_width);

/// Smooths the outline of what has readings: a pixel keeps or gets a reading where at least half of
/// the (2 radius + 1)^2 square around it has one (a majority filter of the silhouette; pixels
/// beyond the picture count as empty). A reading that is given is the mean, with its colour, of
/// those of the square that lie within 0.1 m of the farthest: gaps beside a limb belong to what
/// is behind it. Inside and far outside, nothing changes. radius 0: nothing at all.
void smooth_outline(DepthSurface& surface, int radius_px);

}  // namespace kino
