#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/light/shade.glsl"
layout(push_constant, scalar) uniform Push { FinalParams p; };
layout(set = 0, binding = 0) uniform sampler2DMS samples;
layout(location = 0) out vec4 out_linear;
layout(constant_id = 0) const uint kSamples = 4u;
layout(constant_id = 1) const uint kAsShown = 1u;

vec3 shown(vec4 c) {
    vec3 exposed = c.rgb * (c.a > 0.0 ? p.exposure : 1.0);
    return p.tone_map != 0u && c.a > 0.0 ? roll_off(exposed) : clamp(exposed, 0.0, 1.0);
}

// What shown() makes of it; the curve's highest places are as good as infinite.
vec3 unshown(vec3 c) {
    const float kKnee = 0.7;
    vec3 t = clamp((c - kKnee) / (1.0 - kKnee), 0.0, 0.9995);
    return p.tone_map != 0u ? min(c, kKnee) + (1.0 - kKnee) * t / (1.0 - t) : c;
}

// The mean of a pixel's samples. Of their light: a sample a thousand times as bright as white keeps
// its edge white and stepped. As they are shown: the edge is as smooth as any other; the mean goes
// back through the curve that the last pass will apply again.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    vec4 first = texelFetch(samples, at, 0);
    bool alike = true;
    for (int i = 0; i < int(kSamples); ++i) {
        vec4 c = texelFetch(samples, at, i);
        alike = alike && c == first;
        vec3 exposed = c.rgb * (c.a > 0.0 ? p.exposure : 1.0);
        sum += vec4(kAsShown != 0u ? shown(c) : exposed, c.a);
    }
    vec4 mean = sum / float(kSamples);
    if (mean.a > 0.0) {
        mean.rgb = (kAsShown != 0u ? unshown(mean.rgb) : mean.rgb) / max(p.exposure, 1e-6);
    }
    // What has no edge in it stays the bits it is. Whatever covers a sample covers the pixel.
    out_linear = alike ? first : vec4(mean.rgb, mean.a > 0.0 ? 1.0 : 0.0);
}
