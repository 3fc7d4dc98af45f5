#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/light/color.glsl"
layout(push_constant, scalar) uniform Push {
    ListShadeParams p;
    uint cells_a_slice;
    uint slices;
    float near_m;
    float slice_scale;
};
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(set = 0, binding = 3) uniform usamplerBuffer lights;
layout(set = 0, binding = 4) uniform usamplerBuffer headers;
layout(set = 0, binding = 5) uniform usamplerBuffer indices;
layout(set = 0, binding = 6) uniform usamplerBuffer shadow_masks;
layout(location = 0) out vec4 out_linear;
#include "viz/light/light_loop.glsl"

// The live picture's shader with lists of clusters: tile and slice of depth.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 base = from_srgb(seen.rgb);
    float z = texelFetch(view_z, at, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 q = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * z;
    uvec2 tile = uvec2(gl_FragCoord.xy * p.tile_scale);
    float slice = clamp(log(max(z, near_m) / near_m) * slice_scale, 0.0, float(slices - 1u));
    uvec2 header = texelFetch(headers, int(uint(slice) * cells_a_slice + tile.y * p.tiles_x + tile.x)).xy;
    vec3 irradiance = p.ambient;
    vec3 l;
    uint count = seen.a > 0.0 ? header.y : 0u;
    for (uint k = 0u; k < count; ++k) {
        vec3 light = local_light(texelFetch(indices, int(header.x + k)).x, q, l);
        irradiance += light * max(dot(n, l), 0.0);
    }
    out_linear = vec4(seen.a > 0.0 ? base * irradiance : base, seen.a);
}
