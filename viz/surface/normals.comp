#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/compute_head.glsl"
// A normal for every depth pixel. On a plane a X + b Y + c Z = 1 the inverse depth is linear in
// the viewing ray, 1/z = a x + b y + c, and a triangulating sensor quantises just 1/z evenly: so a
// least-squares fit of 1/z over a 3 x 3 pattern of neighbours gives (a, b, c), the normal's
// direction, without the staircase that differences of positions see. The pattern widens with
// range, as the steps do. Neighbours without a reading or on another surface are left out.
// Output: view space, towards the eye, octahedral in two 16-bit numbers; 0x80008000 is "none",
// where shading falls back to facing the eye.
layout(scalar, set = 0, binding = 0) writeonly buffer Normals { uint normals[]; };
#include "viz/surface/depth_inputs.glsl"

#include "viz/surface/octahedral.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= p.grid.x) return;
    uint i = at.y * p.grid.x + at.x;
    float z = depth_at(i);
    vec2 ray = KINO_RAY(at, i);
    // Spacing in pixels of a 640 px wide image; fewer where the image is coarser.
    float coarseness = p.depth_focal_px / 571.26;
    float spacing = max(round(min(1.0 + 2.2 * z, 10.0) * coarseness), 1.0);
    float step_m = 0.00307 * z * z;
    // The pattern's pixels may lie apart by a surface tilted 65 degrees, or by an ordinary edge.
    float limit = max(edge_limit(p, max(z, 0.1)),
                      2.15 * spacing * z / p.depth_focal_px + 2.0 * step_m);
    float to_unit = p.depth_focal_px / spacing;
    // Normal equations of 1/z = w + u a' + v b', symmetric: s11 is the count.
    float n = 0.0, su = 0.0, sv = 0.0, suu = 0.0, suv = 0.0, svv = 0.0;
    float sw = 0.0, suw = 0.0, svw = 0.0;
    for (int k = 0; k < 9; ++k) {
        ivec2 q = ivec2(at) + int(spacing) * ivec2(k % 3 - 1, k / 3 - 1);
        bool inside = all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, ivec2(p.grid)));
        uint j = inside ? uint(q.y) * p.grid.x + uint(q.x) : i;
        float zq = depth_at(j);
        bool ok = inside && zq > 0.0 && abs(zq - z) < limit;
        vec2 uv = (KINO_RAY(q, j) - ray) * to_unit;
        // Relative to the centre, so that no digits cancel.
        float w = ok ? (z - zq) / (z * zq) : 0.0;
        float one = ok ? 1.0 : 0.0;
        uv = ok ? uv : vec2(0.0);
        n += one;
        su += uv.x;
        sv += uv.y;
        suu += uv.x * uv.x;
        suv += uv.x * uv.y;
        svv += uv.y * uv.y;
        sw += w;
        suw += uv.x * w;
        svw += uv.y * w;
    }
    // Around the mean the 3 x 3 system becomes 2 x 2.
    float inverse_n = 1.0 / max(n, 1.0);
    float cuu = suu - su * su * inverse_n;
    float cuv = suv - su * sv * inverse_n;
    float cvv = svv - sv * sv * inverse_n;
    float cuw = suw - su * sw * inverse_n;
    float cvw = svw - sv * sw * inverse_n;
    float det = cuu * cvv - cuv * cuv;
    bool ok = z > 0.0 && n >= 3.0 && det > 1e-3;
    float inverse_det = ok ? 1.0 / det : 0.0;
    vec2 slope = vec2(cuw * cvv - cvw * cuv, cvw * cuu - cuw * cuv) * inverse_det * to_unit;
    float constant = ok ? 1.0 / z + sw * inverse_n -
                              dot(slope, vec2(su, sv)) * inverse_n / to_unit -
                              dot(slope, ray)
                        : -1.0;
    vec3 normal = vec3(slope, constant);
    float squared = dot(normal, normal);
    ok = ok && squared > 1e-12;
    normal = ok ? normal * inversesqrt(squared) : vec3(0.0, 0.0, -1.0);
    // Facing the depth camera, which sits at the origin of its own space.
    if (dot(normal, vec3(ray, 1.0)) > 0.0) normal = -normal;
    vec3 v = vec3(dot(p.view_from_depth_x.xyz, normal), dot(p.view_from_depth_y.xyz, normal),
                  dot(p.view_from_depth_z.xyz, normal));
    normals[i] = ok ? pack_octahedral(v) : 0x80008000u;
}
