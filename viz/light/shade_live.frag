#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/light/color.glsl"
layout(push_constant, scalar) uniform Push { ListShadeParams p; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(set = 0, binding = 3) uniform usamplerBuffer lights;
layout(set = 0, binding = 4) uniform usamplerBuffer headers;
layout(set = 0, binding = 5) uniform usamplerBuffer indices;
layout(set = 0, binding = 6) uniform usamplerBuffer shadow_masks;
layout(location = 0) out vec4 out_linear;
#include "viz/light/light_loop.glsl"
layout(constant_id = 5) const uint kMixed = 0u;
#include "viz/light/shade_part.glsl"

// A picture of nothing but captured surfaces: Lambert and lists.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 captured = from_srgb(seen.rgb);
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 q = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * texelFetch(view_z, at, 0).r;
    uint pixel = uint(at.y) * p.row_px + uint(at.x);
    vec3 irradiance = own_light(kMixed != 0u ? vec3(1.0) : p.ambient);
    vec3 l;
    bool there = seen.a > 0.0;
    if (kGlobals != 0u) {
        for (uint i = 0u; i < p.globals; ++i) {
            vec3 light = global_light(i, l);
            irradiance += light * (max(dot(n, l), 0.0) * unmasked(i, i, 0u, pixel));
        }
    }
    TileList list = list_at(gl_FragCoord.xy);
    uint count = there ? list.count : 0u;
    for (uint k = 0u; k < count; ++k) {
        uint i = light_in(list, k);
        vec3 light = local_light(i, q, l);
        irradiance += light * (max(dot(n, l), 0.0) * unmasked(i, p.globals + k, 0u, pixel));
    }
    out_linear = part_of_pixel(captured * irradiance, captured, seen.a);
}
