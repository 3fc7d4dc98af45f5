#ifndef KINO_VIZ_QUALITY_LOD_SHARED_H
#define KINO_VIZ_QUALITY_LOD_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// A guide word holds what Eq. 1 compares, 16 bits of depth and 8 + 8 of normal:
//   bits 16..31  0: nothing there, else 1 + 4586 log2(z / 0.05 m), a step of 0.015 %
//   bits 8..15   y and bits 0..7 x of the normal over its part towards the viewer
const float kGuideNearLog2 = -4.321928f;  // log2 of 0.05 m
const float kGuideStepsPerOctave = 4586.0f;
const float kGuideMostSteps = 65534.0f;
// The part towards the viewer counts as at least this: a stored half step of n.x / n.z would
// otherwise grow without bound at grazing angles.
const float kGuideLeastTowards = 0.35f;
const float kGuideNormalSteps = 44.0f;  // per unit of n.x / n.z: 1 / 0.35 reaches 126

// Of the spatial kernel over 4x4 coarse pixels, in coarse pixels.
const float kGaussSigma = 0.7f;

struct LodPickParams {
    vec4 fine_k;    // 1/fx, 1/fy, cx, cy of the fine view
    vec4 coarse_k;  // and of the coarse one
    uvec2 fine;
    uvec2 coarse;
    float least_albedo;  // sRGB; 0: colours stay as they are
};

// What every kind of reconstruction reads; distances come squared, times 1 / (2 sigma^2 ln 2).
struct LodParams {
    vec4 fine_k;          // 1/fx, 1/fy, cx, cy
    vec4 coarse_of_fine;  // coarse = fine * xy + zw, pixels, centres at integers
    ivec2 last;           // largest coarse pixel
    uvec2 fine;           // picture size, px
    float z_weight;       // 0: depth does not count, and what is nothing is a colour as others are
    float n_weight;
};

struct LodTileParams {
    vec4 coarse_of_fine;
    vec4 coarse_k;  // 1/fx, 1/fy, cx, cy
    uvec2 fine;
    ivec2 last;
    uvec2 tiles;
    float depth_steps;  // neighbours closer than this in the guide are one surface
    float normal_steps;
};

// Two lists of rectangles after the two indirect draws that read them.
struct LodRuns {
    uint flat_vertices;  // VkDrawIndirectCommand
    uint flat_count;
    uint flat_first_vertex;
    uint flat_first_instance;
    uint edge_vertices;
    uint edge_count;
    uint edge_first_vertex;
    uint edge_first_instance;
};

KINO_SHARED_END

#define KINO_LOD_TILE_PX 16
#endif
