#ifndef KINO_VIZ_SKELETON_SHARED_H
#define KINO_VIZ_SKELETON_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// A bone (or a joint: both ends equal) as a capsule in view space.
struct CapsuleRecord {
    vec3 a;
    float radius_a;  // metres
    vec3 b;
    float radius_b;
    vec3 color;    // sRGB
    float dashed;  // 1: drawn in dashes along its length
};

struct SkeletonParams {
    vec4 k;       // fx, fy, cx, cy of the view
    vec2 target;  // px
    float near_m;
    float dimmed;  // opacity of what lies behind the surface
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::CapsuleRecord) == 48);
#endif
#endif
