#ifndef KINO_APPS_BENCH_LOD_STAGE_SHARED_H
#define KINO_APPS_BENCH_LOD_STAGE_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct LodStageParams {
    vec4 k;      // 1/fx, 1/fy, cx, cy of the view that is shaded
    uint trips;  // what the costly term repeats: taps of a side, octaves, rays, lights
};

KINO_SHARED_END
#endif
