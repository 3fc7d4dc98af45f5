#ifndef KINO_VIZ_FRAME_EDGE_SAMPLES_SHARED_H
#define KINO_VIZ_FRAME_EDGE_SAMPLES_SHARED_H
#include "viz/light/light_shared.h"
#include "viz/quality/lod_shared.h"

KINO_SHARED_BEGIN

struct EdgeSampleParams {
    LodParams lod;  // coarse_of_fine: what is weighed is the fine picture itself
    FinalParams final;
    float least_albedo;  // linear; ratios of colours below it are 1
    uvec2 background;    // top and bottom, packed sRGB
};

KINO_SHARED_END
#endif
