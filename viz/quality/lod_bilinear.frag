#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_shared.h"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_up.glsl"
#include "viz/light/final_color.glsl"
layout(push_constant, scalar) uniform Push {
    LodParams p;
    FinalParams final_params;
};
layout(set = 0, binding = 0) uniform sampler2D coarse_linear;
#include "viz/quality/lod_constants.glsl"

// Plain bilinear resizing, which knows nothing of edges: the rival.
void main() {
    Footprint at = footprint_of(floor(gl_FragCoord.xy), p.coarse_of_fine, p.last);
    vec4 upper = mix(texelFetch(coarse_linear, at.a, 0),
                     texelFetch(coarse_linear, ivec2(at.b.x, at.a.y), 0), at.t.x);
    vec4 lower = mix(texelFetch(coarse_linear, ivec2(at.a.x, at.b.y), 0),
                     texelFetch(coarse_linear, at.b, 0), at.t.x);
    put_linear(mix(upper, lower, at.t.y));
}
