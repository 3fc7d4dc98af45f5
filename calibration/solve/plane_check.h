#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// A flat part of one depth frame.
struct FlatPart {
    double distance_m = 0;  ///< median depth
    double rms_mm = 0;      ///< of the points' distances from the plane
    int points = 0;
};

/// Flat parts at about one distance, taken together.
struct PlaneBand {
    double distance_m = 0;  ///< mean of the parts
    int planes = 0;
    double rms_mm = 0;  ///< root of the mean square
};

/// The flat parts of a depth frame, without any board: the picture's tiles of 32 x 32 px are fitted
/// with planes; a tile counts if nine tenths of it have depth and its points lie within four
/// quantisation steps (Rig::quantisation_step_m) of the plane. Depth in metres, 0 = none; `rays` of
/// the same size.
[[nodiscard]] std::vector<FlatPart> flat_parts(const Image<float>& depth_m,
                                               const Image<RayXy>& rays);

/// By distance, in bands of 0.25 m; bands with fewer than five parts are left out. Sorted.
[[nodiscard]] std::vector<PlaneBand> by_distance(const std::vector<FlatPart>& parts);

}  // namespace kino
