#ifndef KINO_VIZ_SURFACE_SHARED_H
#define KINO_VIZ_SURFACE_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// Everything the depth rasterisers need to know, 128 bytes of push constants.
struct SurfaceParams {
    vec4 view_from_depth_x;  // rows of the rigid transform: view = row.xyz * p + row.w
    vec4 view_from_depth_y;
    vec4 view_from_depth_z;
    vec4 k;        // fx, fy, cx, cy of the view, px, pixel centres at integers
    uvec2 target;  // picture size, px
    uvec2 grid;    // depth image size, px
    vec4 depth_k;  // 1/fx, 1/fy, cx, cy of the depth camera where it is a plain pinhole
    float near_m;
    float depth_focal_px;
    float fixed_edge_m;  // > 0: this limit for every depth; 0: T(z)
    uint splat_cap_px;
    uvec2 background;  // top and bottom, packed RGBA8
    uint fill_holes;
    uint key_pass;  // 32-bit keys: 0 writes depth, 1 writes the winner's index
};

// What a triangle that is too large, or crosses the near plane, waits in.
struct LargeList {
    uint groups_x;  // VkDispatchIndirectCommand
    uint groups_y;
    uint groups_z;
    uint count;  // may run past the capacity; the surplus is counted, not stored
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::SurfaceParams) == 128);
#else
// A cell whose bounds hold more pixels than this goes to the list of large triangles: a lane that
// walks many pixels holds up all others.
#define KINO_MICRO_LIMIT_PIXELS 32
// Large triangles that share a work group.
#define KINO_TRIANGLES_A_GROUP 8u
// An empty pixel of the visibility buffer: no depth is this large.
#define KINO_EMPTY 0xFFFFFFFFu
#endif
#endif
