#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/light/color.glsl"
layout(push_constant) uniform Push { vec3 ambient; uint row_px; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform usamplerBuffer irradiance;
layout(location = 0) out vec4 out_linear;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 light = uintBitsToFloat(texelFetch(irradiance, at.y * int(row_px) + at.x)).rgb;
    vec3 base = from_srgb(seen.rgb);
    out_linear = vec4(seen.a > 0.0 ? base * (ambient + light) : base, seen.a);
}
