#ifndef KINO_VIZ_QUALITY_LOD_FIX_SHARED_H
#define KINO_VIZ_QUALITY_LOD_FIX_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// How doubtful a pixel is, a whole number from 0 (sure) to 63: 8 sqrt(-log2 W), W its confidence
// in [0, 1]. Equal steps are equal distances in sigmas; 63 is W = 2^-62 and all below.
const float kDoubtSteps = 8.0f;
const float kMostDoubt = 63.0f;
const uint kDoubtBins = 64u;

struct LodFixParams {
    uvec2 fine;   // picture size, px
    uint strips;  // of kStripPx pixels, in a row
    uint cap;     // most pixels in the list
    uint least;   // doubt from which on a pixel is wanted
    uint all_strips;
};

// What the passes of the list tell each other, and the dispatch that walks it.
struct LodFixState {
    uint groups_x;  // VkDispatchIndirectCommand of workgroups of 64
    uint groups_y;
    uint groups_z;
    uint count;   // pixels in the list
    uint failed;  // pixels that are doubtful enough, listed or not
    uint cut;     // doubt above which a pixel is listed
    uint share;   // of pixels with doubt `cut`, of 2^16
    uint bins[64];
};

KINO_SHARED_END

// Pixels that one lane looks at.
#define KINO_LOD_STRIP_PX 64

#ifdef __cplusplus
static_assert(sizeof(kino::shared::LodFixState) == 284);
static_assert(sizeof(kino::shared::LodFixParams) == 24);
#endif
#endif
