#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/guided_depth_shared.h"
#include "viz/quality/lod_shared.h"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
layout(push_constant, scalar) uniform Push { GuidedDepthParams p; };
layout(set = 0, binding = 0) uniform sampler2D depth;
layout(set = 0, binding = 1) uniform sampler2D color;
layout(location = 0) out float out_depth;

// And whether the colour is known.
vec2 luma_at(ivec2 at) {
    vec4 c = texelFetch(color, clamp(at, ivec2(0), p.fine_last), 0);
    return vec2(dot(c.rgb, vec3(0.299, 0.587, 0.114)), c.a > 0.0 ? 1.0 : 0.0);
}

// Eq. 1 with the colour picture for a guide: the surface that the most weight is of, and no other.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    ivec2 corner[4] = ivec2[](at.a, ivec2(at.b.x, at.a.y), ivec2(at.a.x, at.b.y), at.b);
    vec4 f = tent(at.t);
    vec2 own = luma_at(here);
    vec4 z, e;
    for (int j = 0; j < 4; ++j) {
        z[j] = texelFetch(depth, corner[j], 0).r;
        vec2 place = (vec2(corner[j]) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy;
        vec2 other = luma_at(ivec2(floor(place + 0.5)));
        float d = (other.x - own.x) * other.y * own.y;
        e[j] = is_there(z[j]) ? min(d * d * p.luma_weight, kFarthest) : kNothing;
    }
    vec4 w = range_weights(e, f);
    float most = 0.0;
    float surface = 0.0;
    for (int j = 0; j < 4; ++j) {
        float support = 0.0;
        for (int k = 0; k < 4; ++k) {
            bool same = is_there(z[k]) && abs(z[k] - z[j]) <= p.same_surface * z[j];
            support += same ? w[k] : 0.0;
        }
        bool better = is_there(z[j]) && support > most;
        surface = better ? z[j] : surface;
        most = better ? support : most;
    }
    float sum = 0.0;
    float weights = 0.0;
    for (int j = 0; j < 4; ++j) {
        bool same = is_there(z[j]) && abs(z[j] - surface) <= p.same_surface * surface;
        sum += same ? w[j] * z[j] : 0.0;
        weights += same ? w[j] : 0.0;
    }
    // A reading is where the nearest coarse pixel has one.
    int nearest = (at.t.x < 0.5 ? 0 : 1) + (at.t.y < 0.5 ? 0 : 2);
    out_depth = is_there(z[nearest]) ? sum / weights : 0.0;
}
