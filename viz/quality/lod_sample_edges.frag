#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_samples_shared.h"
#include "viz/quality/lod_shared.h"
#include "viz/quality/lod_guide.glsl"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/sample_surface.glsl"
layout(push_constant, scalar) uniform Push { LodEdgeParams p; };
layout(set = 0, binding = 0) uniform sampler2DMS samples;
layout(set = 0, binding = 1) uniform sampler2D albedo;
layout(set = 0, binding = 2) uniform sampler2D view_z;
layout(set = 0, binding = 3) uniform sampler2D normal;
layout(set = 0, binding = 4) uniform usampler2D object;
layout(location = 0) out float out_rank;

const float kLeastTowards = 0.05;

// 0: one surface; else 1 .. 63 over 255, the higher the more colours differ.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uint own = texelFetch(object, at, 0).r;
    vec4 texel[4];
    for (int s = 0; s < 4; ++s) texel[s] = texelFetch(samples, at, s);
    bool alike = sample_object(texel[0]) == own && texel[0] == texel[1] && texel[0] == texel[2] &&
                 texel[0] == texel[3];
    bool edge = false;
    float contrast = 0.0;
    // Most pixels are in the middle of a triangle: a loop without a turn costs nothing, a branch
    // would.
    int turns = alike ? 0 : 4;
    for (int s = 0; s < turns; ++s) {
        float z = texelFetch(view_z, at, 0).r;
        vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
        vec3 color = texelFetch(albedo, at, 0).rgb;
        bool there = is_there(z);
        vec2 slope = n.xy / max(-n.z, kLeastTowards);
        float facing =
            abs(dot(n, vec3((vec2(at) - p.fine_k.zw) * p.fine_k.xy, 1.0))) / (there ? z : 1.0);
        vec4 what = texelFetch(samples, at, s);
        vec3 other = sample_normal(what);
        vec2 apart = other.xy / max(-other.z, kLeastTowards) - slope;
        bool other_there = is_there(sample_z(what));
        // Between two that are nothing there is no edge, whatever else they hold.
        bool differs = other_there != there || sample_object(what) != own;
        differs = differs || (there && (facing * abs(sample_z(what) - z) > p.z_limit ||
                                        dot(apart, apart) > p.n_limit * p.n_limit));
        edge = edge || differs;
        vec3 off = abs(sample_albedo(what).rgb - color);
        contrast = max(contrast, max(off.r, max(off.g, off.b)));
    }
    out_rank = edge ? (1.0 + round(62.0 * min(contrast, 1.0))) / 255.0 : 0.0;
}
