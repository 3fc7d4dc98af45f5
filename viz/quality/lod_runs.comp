#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LodTileParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer edge_of_tile;
layout(scalar, set = 0, binding = 1) buffer Runs { LodRuns runs; };
layout(scalar, set = 0, binding = 2) writeonly buffer Flat { uvec2 flat_runs[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer Edge { uvec2 edge_runs[]; };

// Tiles of one kind that lie side by side become one rectangle: triangles cost more than pixels.
void main() {
    uint y = gl_GlobalInvocationID.x;
    if (y >= p.tiles.y) return;
    uint first = 0u;
    uint kind = texelFetch(edge_of_tile, int(y * p.tiles.x)).r;
    for (uint x = 1u; x <= p.tiles.x; ++x) {
        uint next = x < p.tiles.x ? texelFetch(edge_of_tile, int(y * p.tiles.x + x)).r : 2u;
        if (next != kind) {
            uvec2 run = uvec2(first | x << 16, y);
            if (kind == 0u) {
                flat_runs[atomicAdd(runs.flat_count, 1u)] = run;
            } else {
                edge_runs[atomicAdd(runs.edge_count, 1u)] = run;
            }
            first = x;
            kind = next;
        }
    }
}
