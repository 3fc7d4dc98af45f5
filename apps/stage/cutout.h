#pragma once

#include <memory>
#include <optional>

#include "base/body.h"
#include "viz/scene/scene.h"

namespace kino {

/// The depth of people alone: of what is within `margin_m` aside of and before the bones (more at
/// the trunk, less along forearms) and little behind them, that which is connected with a bone from
/// pixel to pixel without a jump. All else has no reading, nor has what lies below `floor_y_m` in
/// the world. The version is the surface's own. What people touch is cut off at the margin, by
/// blocks of 2 x 2 pixels. The outline is smoothed by `outline_px` (apps/stage/outline.h), so a few
/// pixels beside it get readings, too.
[[nodiscard]] std::shared_ptr<const DepthSurface> cut_out_people(
    const DepthSurface& surface, const BodyFrame& bodies, double margin_m,
    const Pose& world_from_depth, std::optional<double> floor_y_m, int outline_px = 0);

}  // namespace kino
