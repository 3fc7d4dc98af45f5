#ifndef KINO_VIZ_QUALITY_GUIDED_DEPTH_SHARED_H
#define KINO_VIZ_QUALITY_GUIDED_DEPTH_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct GuidedDepthParams {
    vec4 coarse_of_fine;  // coarse = fine * xy + zw, pixels, centres at integers
    ivec2 last;           // largest pixel of the depth picture
    ivec2 fine_last;      // and of the colour picture
    float luma_weight;    // 1 / (2 sigma^2 ln 2)
    float same_surface;   // depths that differ by less than this share of them are of one surface
};

KINO_SHARED_END
#endif
