#pragma once

#include "base/image.h"

namespace kino::reference {

struct GuidedDepthRules {
    double sigma_luma = 0.1;
    double same_surface = 0.025;
    double offset_px = 0;
};

struct GuidedDepthPixel {
    double z = 0;       ///< metres; 0: no reading
    double margin = 0;  ///< by how much more weight is of its surface than of any other
};

/// One pixel of depth brought to the size of a colour picture, in double precision, written from
/// the contract of viz/quality/guided_depth.h.
[[nodiscard]] GuidedDepthPixel guided_depth(const Image<float>& depth, const Image<Rgba8>& color,
                                            int x, int y, const GuidedDepthRules& rules);

}  // namespace kino::reference
