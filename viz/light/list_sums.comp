#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
layout(local_size_x = 1) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer counted;
layout(scalar, set = 0, binding = 1) writeonly buffer Headers { uvec2 headers[]; };
layout(scalar, set = 0, binding = 2) buffer Counters { LightListCounters counters; };

// Where each tile's segment begins: a sum over a few thousand tiles, which one lane adds up in less
// time than passes cost that share the work. What the pool has no room for is cut off and counted.
void main() {
    uint used = 0u;
    uint lost = 0u;
    for (uint tile = 0u; tile < p.tiles.x * p.tiles.y; ++tile) {
        uint wanted = texelFetch(counted, int(tile)).y;
        uint given = min(wanted, p.pool - used);
        headers[tile] = uvec2(used, given);
        used += given;
        lost += wanted - given;
    }
    counters.pool_dropped = lost;
}
