#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_shared.h"
layout(push_constant, scalar) uniform Push { LodParams p; };
layout(scalar, set = 0, binding = 0) readonly buffer Rectangles { uvec2 rectangles[]; };

// Two triangles for each run of tiles.
void main() {
    uvec2 run = rectangles[gl_InstanceIndex];
    uvec2 from = uvec2(run.x & 0xFFFFu, run.y) * KINO_LOD_TILE_PX;
    uvec2 to = uvec2(run.x >> 16, run.y + 1u) * KINO_LOD_TILE_PX;
    const uint kRight = 0x2Cu;  // of vertices 2, 3 and 5
    const uint kBelow = 0x32u;  // of vertices 1, 4 and 5
    vec2 corner = vec2((kRight >> gl_VertexIndex & 1u) != 0u ? to.x : from.x,
                       (kBelow >> gl_VertexIndex & 1u) != 0u ? to.y : from.y);
    gl_Position = vec4(corner / vec2(p.fine) * 2.0 - 1.0, 1.0, 1.0);
}
