#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/light/color.glsl"
#include "viz/light/shade.glsl"
layout(push_constant, scalar) uniform Push { LightParams p; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(scalar, set = 0, binding = 3) readonly buffer Lights { LightRecord lights[]; };
layout(location = 0) out vec4 out_linear;

// Light for every pixel of the picture: the reference for shading at the rate of depth pixels.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 captured = from_srgb(seen.rgb);
    float z = texelFetch(view_z, at, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 q = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * z;
    vec3 irradiance = p.mixed != 0u ? vec3(1.0) : p.ambient;
    // Nothing there: no trips.
    uint count = seen.a > 0.0 ? p.count : 0u;
    for (uint i = 0u; i < count; ++i) {
        irradiance += light_at(lights[i], q, n);
    }
    out_linear = vec4(seen.a > 0.0 ? captured * irradiance : captured, seen.a);
}
