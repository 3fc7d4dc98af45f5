#ifndef KINO_VIZ_LIGHT_SHADOW_SHARED_H
#define KINO_VIZ_LIGHT_SHADOW_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// All passes of ray-cast shadows, 128 bytes of push constants.
struct ShadowParams {
    vec4 tree_from_view_x;  // rows of the rigid transform into the tree's space
    vec4 tree_from_view_y;
    vec4 tree_from_view_z;
    vec4 k;           // 1/fx, 1/fy, cx, cy of the view
    uvec2 size;       // of the view, px
    uvec2 texels;     // of the traced masks
    vec2 tile_scale;  // pixel of the view to tile
    uint tiles_x;
    uint globals;
    uint locals;
    uint most_rays;  // of one texel
    float offset;    // a ray starts this share of the largest coordinate off its surface
    uint first_row;  // of this band of texels
    uint rows;
    float live_bias_m;  // hits of the live frame nearer than this do not count
};

struct ShadowCounters {
    uint groups_x;  // VkDispatchIndirectCommand of the band
    uint groups_y;
    uint groups_z;
    uint band_jobs;
    uint jobs;    // of all bands
    uint capped;  // lights with shadows that got no ray, because their texel had its share
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::ShadowParams) <= 128);
static_assert(sizeof(kino::shared::ShadowCounters) == 24);
#endif
#endif
