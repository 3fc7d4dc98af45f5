#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/quality/lod_color.glsl"
layout(constant_id = 0) const uint kFineGrained = 1;
layout(set = 0, binding = 0) uniform sampler2D coarse_linear;
layout(set = 0, binding = 1) uniform sampler2D coarse_albedo;
layout(location = 0) out vec4 out_light;

// The coarse picture, finite; fine-grained: without its albedo, which is never zero.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 light = finite_light(texelFetch(coarse_linear, at, 0).rgb);
    if (kFineGrained != 0u) {
        light /= max(from_srgb(texelFetch(coarse_albedo, at, 0).rgb), 1e-3);
    }
    out_light = vec4(min(light, 65000.0), 1.0);
}
