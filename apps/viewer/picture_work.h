#pragma once

#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

/// What a frame will have to do, counted before it is drawn.
struct PictureWork {
    double lights = 1;  ///< lights over a pixel, in the mean; above 0, for pixels without any count
    double triangles = 1;
    friend bool operator==(const PictureWork&, const PictureWork&) = default;
};

/// Lights count with the share of the picture that their spheres' bounds cover, which is more than
/// they light; triangles are those of the meshes.
[[nodiscard]] PictureWork count_work(const Scene& scene, const View& view);

}  // namespace kino
