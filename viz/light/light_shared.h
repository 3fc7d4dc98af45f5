#ifndef KINO_VIZ_LIGHT_SHARED_H
#define KINO_VIZ_LIGHT_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

struct LightRecord {
    vec3 place;    // view space: position of a point light, direction to a directional one
    uint kind;     // 0 directional, 1 point
    vec3 color;    // linear
    float radius;  // metres, point lights
};

struct LightParams {
    vec4 k;  // fx, fy, cx, cy of the view
    vec3 ambient;
    uint count;
    uint mixed;  // 1: captured light stays and virtual light adds; 0: relit
};

// What the point shader reads beside the surface's own push constants.
struct PointLightParams {
    vec3 ambient;
    uint count;
    uint mixed;
    float exposure;
};

struct FinalParams {
    float exposure;
    uint tone_map;  // 0: clip, so captured colours stay what they are; 1: roll off the highlights
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::LightRecord) == 32);
#endif
#endif
