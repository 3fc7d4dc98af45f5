#pragma once

#include <memory>
#include <optional>

#include "base/body.h"
#include "viz/scene/scene.h"

namespace kino {

/// The depth of people alone: what is farther than `margin_m` before or behind the bones (twice
/// that at the trunk, as far as hands reach), or aside of them, has no reading; and what lies below
/// `floor_y_m` in the world. The version is the surface's own. Decided for blocks of 4 x 4 pixels
/// by spheres along the bones, so edges towards things that people touch are rough.
[[nodiscard]] std::shared_ptr<const DepthSurface> cut_out_people(const DepthSurface& surface,
                                                                 const BodyFrame& bodies,
                                                                 double margin_m,
                                                                 const Pose& world_from_depth,
                                                                 std::optional<double> floor_y_m);

}  // namespace kino
