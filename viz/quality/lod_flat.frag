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
layout(set = 0, binding = 1) uniform sampler2D coarse_light;
layout(set = 0, binding = 2) uniform sampler2D albedo;
#include "viz/quality/lod_constants.glsl"

// Where all coarse neighbours are of one surface: no guides, only light.
void main() {
    Footprint at = footprint_of(floor(gl_FragCoord.xy), p.coarse_of_fine, p.last);
    put(tent_light(coarse_light, at), texelFetch(albedo, ivec2(gl_FragCoord.xy), 0), 0.0);
}
