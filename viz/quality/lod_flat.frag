#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_shared.h"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_up.glsl"
layout(push_constant, scalar) uniform Push { LodParams p; };
layout(constant_id = 0) const uint kFineGrained = 1;
layout(constant_id = 1) const uint kKeepBackground = 1;
layout(set = 0, binding = 1) uniform sampler2D coarse_light;
layout(set = 0, binding = 2) uniform sampler2D albedo;
layout(location = 0) out vec4 out_linear;

// Where all coarse neighbours are of one surface: no guides, only light.
void main() {
    Footprint at = footprint_of(floor(gl_FragCoord.xy), p.coarse_of_fine, p.last);
    vec4 f = tent(at.t);
    vec3 light = f.x * texelFetch(coarse_light, at.a, 0).rgb +
                 f.y * texelFetch(coarse_light, ivec2(at.b.x, at.a.y), 0).rgb +
                 f.z * texelFetch(coarse_light, ivec2(at.a.x, at.b.y), 0).rgb +
                 f.w * texelFetch(coarse_light, at.b, 0).rgb;
    vec4 seen = texelFetch(albedo, ivec2(gl_FragCoord.xy), 0);
    vec3 own = from_srgb(seen.rgb);
    if (kFineGrained != 0u) light *= own;
    if (kKeepBackground != 0u && seen.a == 0.0) light = own;
    out_linear = vec4(light, seen.a);
}
