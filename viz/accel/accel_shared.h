#ifndef KINO_VIZ_ACCEL_SHARED_H
#define KINO_VIZ_ACCEL_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// One node of the tree, 32 bytes: two texels of a Binding::word_quads.
struct BvhNode {
    vec3 lo;
    uint first;  // leaf: its first triangle, in the tree's order
    vec3 hi;
    uint word;  // bits 0-1 axis of the cut, bit 2 leaf, bits 3-31 triangles; 0: there is no node
};

// One triangle in the tree's order, 48 bytes: three texels.
struct BvhTriangle {
    vec3 a;
    uint id;  // its place in the soup
    vec3 b;
    uint reserved_b;
    vec3 c;
    uint reserved_c;
};

// What turns a place into a Morton code.
struct MortonFrame {
    vec3 lo;
    uint reserved;
    vec3 cells;    // along each axis: 2^bits, as a float
    uint axes_lo;  // axes of the code's bits 0-14, two bits each, lowest first
    vec3 scale;    // cells / extent; 0 where the extent is 0
    uint axes_hi;  // axes of bits 15-29
};

struct BuildParams {
    uint triangles;
    uint lanes;  // that share the sort
    uint shift;  // of the digit that is sorted by
    uint level;
    uint leaf_triangles;  // cut no further from here
    uint last_level;
};

struct TraceRay {
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
};

struct TraceHit {
    float t;
    uint triangle;  // place in the soup; ~0: nothing hit
    float v;        // weights of corners b and c
    float w;
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::BvhNode) == 32);
static_assert(sizeof(kino::shared::BvhTriangle) == 48);
static_assert(sizeof(kino::shared::MortonFrame) == 48);
static_assert(sizeof(kino::shared::TraceRay) == 32);
static_assert(sizeof(kino::shared::TraceHit) == 16);
#endif
#endif
