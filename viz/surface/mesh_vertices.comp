#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/compute_head.glsl"
// Every depth pixel as a vertex of four words: framebuffer x and y, 1 / view depth (negative:
// nearer than the near plane, the large list clips it), and which of the two triangles of the
// cell to its lower right belong to one surface (bits 0 and 1).
layout(scalar, set = 0, binding = 0) writeonly buffer Vertices { vec4 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Depth { float depth_m[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Rays { vec2 rays[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.grid.x * p.grid.y) return;
    uvec2 at = uvec2(i % p.grid.x, i / p.grid.x);
    float z = depth_m[i];
    vec3 v = to_view(p, depth_point(z, rays[i]));
    float inverse_z = v.z >= p.near_m ? 1.0 / v.z : -1.0;
    vec2 centre = p.k.xy * v.xy * inverse_z + p.k.zw + 0.5;
    // The last row and column start no cell.
    bool cell = at.x + 1u < p.grid.x && at.y + 1u < p.grid.y;
    float right = depth_m[cell ? i + 1u : i];
    float below = depth_m[cell ? i + p.grid.x : i];
    float across = depth_m[cell ? i + p.grid.x + 1u : i];
    uint kept = (keep_triangle(p, z, right, below) ? 1u : 0u) |
                (keep_triangle(p, right, across, below) ? 2u : 0u);
    vertices[i] = vec4(centre, inverse_z, uintBitsToFloat(cell ? kept : 0u));
}
