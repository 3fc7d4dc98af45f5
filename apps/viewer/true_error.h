#pragma once

#include "viz/frame/renderer.h"

namespace kino {

/// What a frame's levels lose against the same frame in full.
struct TrueError {
    double psnr_db = 0;        ///< infinity: the same picture
    double flip = 0;           ///< mean FLIP
    double failed_pixels = 0;  ///< share whose FLIP is above kFailedFlip
};
constexpr float kFailedFlip = 0.2f;

/// Draws twice, with `drawn` and without its LOD and zoom, and compares: some hundred milliseconds.
[[nodiscard]] Result<TrueError> measure_true_error(Renderer& renderer, const Scene& scene,
                                                   const View& view, const FrameOptions& drawn);

}  // namespace kino
