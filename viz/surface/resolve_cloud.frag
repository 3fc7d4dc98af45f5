#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/resolve_head.glsl"

void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec2 hit = visibility[at.y * p.target.x + at.x];
    // Holes: a loop whose trip count is data, so covered pixels do not pay for it.
    int tries = hit.y == KINO_EMPTY && p.fill_holes != 0u ? 9 : 0;
    uint around = 0u;
    uvec2 nearest = uvec2(KINO_EMPTY);
    for (int k = 0; k < tries; ++k) {
        ivec2 q = clamp(ivec2(at) + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), ivec2(p.target) - 1);
        uvec2 other = visibility[uint(q.y) * p.target.x + uint(q.x)];
        if (other.y != KINO_EMPTY) ++around;
        if (other.y < nearest.y) nearest = other;
    }
    // Half the neighbours present means a hole inside a surface, fewer its outer edge.
    if (around >= 4u) hit = nearest;

    bool covered = hit.y != KINO_EMPTY;
    uint i = covered ? hit.x : 0u;
    vec4 rgba = kHasColor != 0u ? unpackUnorm4x8(color[i]) : vec4(0.0);
    vec3 seen = rgba.a > 0.0 ? rgba.rgb : kUncoloured;
    out_albedo = covered ? vec4(seen, 1.0)
                         : vec4(background_at(gl_FragCoord.y / float(p.target.y)), 0.0);
    out_view_z = covered ? uintBitsToFloat(hit.y) : 0.0;
    out_id = covered ? hit.x : KINO_EMPTY;
    out_normal = vec2(0.0);
    if (kWantNormal != 0u) {
        uint bits = normals[i];
        vec3 ray = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0);
        out_normal = bits != 0x80008000u ? unpackSnorm2x16(bits) : to_octahedral(-normalize(ray));
    }
}
