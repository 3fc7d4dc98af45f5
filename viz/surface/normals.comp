#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/compute_head.glsl"
// Normals by Sobel on positions, not on depth: neighbours that are invalid or across an edge are
// left out, so a silhouette gets a one-sided slope instead of a false one. View space, towards the
// eye, octahedral in two 16-bit signed numbers; 0x80008000 marks "none", where shading falls back
// to facing the eye.
layout(scalar, set = 0, binding = 0) writeonly buffer Normals { uint normals[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Depth { float depth_m[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Rays { vec2 rays[]; };

#include "viz/surface/octahedral.glsl"

// Sum of differences along one axis over three lines, weights 1 2 1; .w counts the weights.
vec4 slope(ivec2 at, ivec2 along, ivec2 across, float z, float limit, int reach) {
    vec4 sum = vec4(0.0);
    for (int k = -1; k <= 1; ++k) {
        ivec2 a = clamp(at + k * reach * across - reach * along, ivec2(0), ivec2(p.grid) - 1);
        ivec2 b = clamp(at + k * reach * across + reach * along, ivec2(0), ivec2(p.grid) - 1);
        ivec2 m = clamp(at + k * reach * across, ivec2(0), ivec2(p.grid) - 1);
        uint ia = uint(a.y) * p.grid.x + uint(a.x);
        uint ib = uint(b.y) * p.grid.x + uint(b.x);
        uint im = uint(m.y) * p.grid.x + uint(m.x);
        float za = depth_m[ia];
        float zb = depth_m[ib];
        float zm = depth_m[im];
        bool ok_a = za > 0.0 && abs(za - z) < limit;
        bool ok_b = zb > 0.0 && abs(zb - z) < limit;
        bool ok_m = zm > 0.0 && abs(zm - z) < limit;
        float weight = k == 0 ? 2.0 : 1.0;
        vec3 pa = depth_point(za, rays[ia]);
        vec3 pb = depth_point(zb, rays[ib]);
        vec3 pm = depth_point(zm, rays[im]);
        if (ok_a && ok_b) {
            sum += vec4(weight * (pb - pa), 2.0 * weight);
        } else if (ok_b && ok_m) {
            sum += vec4(weight * (pb - pm), weight);
        } else if (ok_a && ok_m) {
            sum += vec4(weight * (pm - pa), weight);
        }
    }
    return sum;
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.grid.x * p.grid.y) return;
    float z = depth_m[i];
    ivec2 at = ivec2(i % p.grid.x, i / p.grid.x);
    // The quantisation staircase grows with z^2, so the window does too (1, 2 or 3 pixels).
    int reach = int(clamp(1.0 + floor(z * z * 0.25), 1.0, 3.0));
    float limit = float(reach) * edge_limit(p, max(z, 0.1));
    vec4 sx = slope(at, ivec2(1, 0), ivec2(0, 1), z, limit, reach);
    vec4 sy = slope(at, ivec2(0, 1), ivec2(1, 0), z, limit, reach);
    vec3 n = cross(sx.xyz / max(sx.w, 1.0), sy.xyz / max(sy.w, 1.0));
    float squared = dot(n, n);
    bool ok = z > 0.0 && sx.w > 0.0 && sy.w > 0.0 && squared > 1e-16;
    n = ok ? n * inversesqrt(squared) : vec3(0.0, 0.0, -1.0);
    // Facing the depth camera, which sits at the origin of its own space.
    if (dot(n, vec3(rays[i], 1.0)) > 0.0) n = -n;
    vec3 v = vec3(dot(p.view_from_depth_x.xyz, n), dot(p.view_from_depth_y.xyz, n),
                  dot(p.view_from_depth_z.xyz, n));
    normals[i] = ok ? pack_octahedral(v) : 0x80008000u;
}
