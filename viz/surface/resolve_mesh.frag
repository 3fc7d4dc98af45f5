#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/resolve_head.glsl"

void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec2 hit = visibility_at(at.y * p.target.x + at.x);
    bool covered = hit.y != KINO_EMPTY;
    uvec3 corner = triangle_corners(p, covered ? hit.x : 0u);
    vec3 ray = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0);

    // Weights of the corners where the pixel's ray meets the triangle, in depth-camera space: the
    // point is known from its depth, so no plane is needed.
    vec3 in_view = ray * uintBitsToFloat(hit.y)
                 - vec3(p.view_from_depth_x.w, p.view_from_depth_y.w, p.view_from_depth_z.w);
    vec3 q = p.view_from_depth_x.xyz * in_view.x + p.view_from_depth_y.xyz * in_view.y +
             p.view_from_depth_z.xyz * in_view.z;
    vec3 a = depth_point(depth_at(corner.x), ray_at(corner.x));
    vec3 ab = depth_point(depth_at(corner.y), ray_at(corner.y)) - a;
    vec3 ac = depth_point(depth_at(corner.z), ray_at(corner.z)) - a;
    vec3 n = cross(ab, ac);
    float scale = 1.0 / max(dot(n, n), 1e-20);
    vec3 w;
    w.y = clamp(dot(cross(q - a, ac), n) * scale, 0.0, 1.0);
    w.z = clamp(dot(cross(ab, q - a), n) * scale, 0.0, 1.0 - w.y);
    w.x = 1.0 - w.y - w.z;

    vec3 seen = kUncoloured;
    if (kHasColor != 0u) {
        vec4 ca = unpackUnorm4x8(color_at(corner.x));
        vec4 cb = unpackUnorm4x8(color_at(corner.y));
        vec4 cc = unpackUnorm4x8(color_at(corner.z));
        // Corners without colour do not darken those that have it.
        vec3 weights = w * vec3(ca.a, cb.a, cc.a);
        float total = weights.x + weights.y + weights.z;
        seen = total > 0.0 ? (ca.rgb * weights.x + cb.rgb * weights.y + cc.rgb * weights.z) / total
                           : kUncoloured;
    }
    out_albedo = covered ? vec4(seen, 1.0)
                         : vec4(background_at(gl_FragCoord.y / float(p.target.y)), 0.0);
    out_view_z = covered ? uintBitsToFloat(hit.y) : 0.0;
    out_id = covered ? hit.x : KINO_EMPTY;
    out_normal = vec2(0.0);
    if (kWantNormal != 0u) {
        vec3 sum = vec3(0.0);
        uint na = normals[corner.x];
        uint nb = normals[corner.y];
        uint nc = normals[corner.z];
        if (na != 0x80008000u) sum += w.x * unpack_octahedral(na);
        if (nb != 0x80008000u) sum += w.y * unpack_octahedral(nb);
        if (nc != 0x80008000u) sum += w.z * unpack_octahedral(nc);
        vec2 known = to_octahedral(dot(sum, sum) > 1e-6 ? normalize(sum) : -normalize(ray));
        out_normal = covered ? known : vec2(0.0);
    }
}
