#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer headers;
layout(scalar, set = 0, binding = 1) buffer Counters { LightListCounters counters; };

void main() {
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= p.tiles.x * p.tiles.y) return;
    uint count = texelFetch(headers, int(tile)).y;
    atomicAdd(counters.listed, count);
    atomicMax(counters.longest, count);
    if (count > 0u) atomicAdd(counters.lit_tiles, 1u);
    atomicAdd(counters.histogram[min((count + 7u) / 8u, 64u)], 1u);
}
