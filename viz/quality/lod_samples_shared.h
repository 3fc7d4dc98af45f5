#ifndef KINO_VIZ_QUALITY_LOD_SAMPLES_SHARED_H
#define KINO_VIZ_QUALITY_LOD_SAMPLES_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct LodEdgeParams {
    vec4 fine_k;    // 1/fx, 1/fy, cx, cy
    float z_limit;  // over the distance; above 1e30: does not count
    float n_limit;  // of n.xy / n.z
};

KINO_SHARED_END
#endif
