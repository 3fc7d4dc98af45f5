#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/resolve_head.glsl"
#include "viz/surface/fill_holes.glsl"

void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec2 hit = nearest_or_filled(at);
    bool covered = hit.y != KINO_EMPTY;
    uint i = covered ? hit.x : 0u;
    vec4 rgba = kHasColor != 0u ? unpackUnorm4x8(color_at(i)) : vec4(0.0);
    vec3 seen = rgba.a > 0.0 ? rgba.rgb : kUncoloured;
    out_albedo = covered ? vec4(seen, 1.0)
                         : vec4(background_at(gl_FragCoord.y / float(p.target.y)), 0.0);
    out_view_z = covered ? uintBitsToFloat(hit.y) : 0.0;
    out_id = covered ? hit.x : KINO_EMPTY;
    out_normal = vec2(0.0);
    if (kWantNormal != 0u) {
        uint bits = normals[i];
        vec3 ray = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0);
        vec2 known = bits != 0x80008000u ? unpackSnorm2x16(bits) : to_octahedral(-normalize(ray));
        out_normal = covered ? known : vec2(0.0);
    }
}
