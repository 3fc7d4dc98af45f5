#ifndef KINO_VIZ_QUALITY_LOD_REGIONS_SHARED_H
#define KINO_VIZ_QUALITY_LOD_REGIONS_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// One level of a picture that is shaded finer by tiles: fine and coarse are that level and the one
// below it.
struct LodRegionParams {
    vec4 fine_k;          // 1/fx, 1/fy, cx, cy
    vec4 coarse_of_fine;  // coarse = fine * xy + zw, texels, centres at integers
    ivec2 last;           // largest coarse texel
    uvec2 fine;           // size, texels
    uvec2 tiles;
    uvec2 parents;  // tiles of the level before; 0: none, all of it is fine
    uint side;      // texels of a tile along a side
    uint parent_side;
    float limit;        // of light; 0: every tile
    float doubt_limit;  // of a texel, exponent to base 2
    float doubt_share;  // of a tile's texels
    float exposure;
    float z_weight;
    float n_weight;
    float depth_steps;  // of neighbours on one surface, in the guide's steps
    float normal_steps;
};

// The dispatch that walks the list, as PixelList wants it.
struct LodRegionState {
    uint groups_x;
    uint groups_y;
    uint groups_z;
    uint count;  // texels in the list
    uint tiles;  // that are shaded finer
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::LodRegionParams) <= 128);
static_assert(sizeof(kino::shared::LodRegionState) == 20);
#endif
#endif
