#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/compute_head.glsl"
// Every depth pixel as a vertex: framebuffer x and y, 1 / view depth (<= 0: nearer than the near
// plane, the large list clips it), and the depth camera's own depth (0: no reading).
layout(scalar, set = 0, binding = 0) writeonly buffer Vertices { vec4 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Depth { float depth_m[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Rays { vec2 rays[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.grid.x * p.grid.y) return;
    float z = depth_m[i];
    vec3 v = to_view(p, depth_point(z, rays[i]));
    bool behind = !(v.z >= p.near_m);
    float inverse_z = behind ? -1.0 : 1.0 / v.z;
    vec2 centre = p.k.xy * v.xy * inverse_z + p.k.zw + 0.5;
    vertices[i] = vec4(centre, inverse_z, z > 0.0 ? z : 0.0);
}
