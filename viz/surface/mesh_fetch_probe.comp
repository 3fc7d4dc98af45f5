#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// What the vertex shader would fetch, written out: for tests and for timing the fetch alone.
#include "viz/surface/mesh_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint row; uint corners; };
#include "viz/surface/mesh_fetch.glsl"
layout(scalar, binding = 4) writeonly buffer Out { vec4 fetched[]; };
layout(scalar, binding = 5) buffer Errors { uint unknown_vertices; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= corners) return;
    uvec4 head = draw_texel(row, 7);
    PulledVertex v = pull_vertex(head.x, head.y, i);
    fetched[3u * i] = vec4(v.position, v.known ? 1.0 : 0.0);
    fetched[3u * i + 1u] = vec4(v.normal, v.uv.x);
    fetched[3u * i + 2u] = vec4(v.color, v.uv.y);
    uint format = head.x >> KINO_FIRST_VERTEX_BITS;
    if (format >= KINO_FORMATS || (kFormats & (1u << format)) == 0u) {
        atomicAdd(unknown_vertices, 1u);
    }
}
