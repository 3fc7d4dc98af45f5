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
#include "viz/light/sample_mean.glsl"

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
        sum += vec4(sample_exposed(c, p), c.a);
    }
    // What has no edge in it stays the bits it is.
    out_linear = alike ? first : mean_of_samples(sum, kSamples, p);
}
