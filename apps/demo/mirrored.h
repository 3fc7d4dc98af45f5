#pragma once

#include <memory>

#include "base/body.h"
#include "skeleton/gestures/gesture_event.h"
#include "viz/scene/scene.h"

namespace kino::demo {

/// As seen in a mirror in the depth camera's plane x = 0: still somebody who faces the camera, with
/// what was their left hand as their right one.
[[nodiscard]] BodyFrame mirrored(const BodyFrame& frame);

/// The same of depth. Keeps the mirrored rays of the last surface, which all of a source share.
class SurfaceMirror {
  public:
    [[nodiscard]] std::shared_ptr<const DepthSurface> of(const DepthSurface& surface);

  private:
    std::shared_ptr<const Image<RayXy>> rays_, mirrored_rays_;
};

}  // namespace kino::demo
