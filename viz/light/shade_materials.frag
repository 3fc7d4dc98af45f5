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
layout(set = 0, binding = 7) uniform usampler2D object;
layout(set = 0, binding = 8) uniform usamplerBuffer materials;
layout(set = 0, binding = 9) uniform usamplerBuffer lobes;
layout(location = 0) out vec4 out_linear;
#include "viz/light/light_loop.glsl"
#include "viz/light/shade_surface.glsl"

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    Surface s;
    s.base = from_srgb(seen.rgb);
    s.normal = from_octahedral(texelFetch(normal, at, 0).rg);
    s.place = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * texelFetch(view_z, at, 0).r;
    s.material = texelFetch(object, at, 0).r >> 16u;
    TileList list = list_at(gl_FragCoord.xy);
    // Nothing there: no trips.
    if (seen.a == 0.0) list.count = 0u;
    vec3 light = shade(s, list, uint(at.y) * p.row_px + uint(at.x));
    out_linear = part_of_pixel(light, s.base, seen.a);
}
