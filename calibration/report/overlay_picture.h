#pragma once

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino {

/// The colour picture, paled, with every depth pixel where `rig` puts it: red near, blue far
/// (`rig`'s own range of this frame), contours of the depth white. At most `widest` px wide. Fails
/// where Rig::create and register_depth do, and without a colour camera of the picture's size.
[[nodiscard]] Result<Image<Rgba8>> depth_over_color(const DepthFrame& depth,
                                                    const Image<Rgba8>& color,
                                                    const RigParameters& rig, int widest = 480);

}  // namespace kino
