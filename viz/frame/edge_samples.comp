#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/frame/edge_samples_shared.h"
#include "viz/light/color.glsl"
#include "viz/light/shade.glsl"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/sample_surface.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { EdgeSampleParams push; };
layout(constant_id = 0) const uint kFineGrained = 1u;
layout(constant_id = 1) const uint kKeepBackground = 1u;
layout(constant_id = 2) const uint kMetric = 2u;
layout(constant_id = 3) const uint kAsShown = 1u;
layout(constant_id = 4) const uint kEmission = 0u;
layout(set = 0, binding = 0) uniform usamplerBuffer listed;
layout(set = 0, binding = 1) uniform usamplerBuffer state;
layout(set = 0, binding = 2) uniform sampler2DMS samples;
layout(set = 0, binding = 3) uniform sampler2D linear;
layout(set = 0, binding = 4) uniform sampler2D albedo;
layout(set = 0, binding = 5) uniform sampler2D view_z;
layout(set = 0, binding = 6) uniform sampler2D normal;
layout(set = 0, binding = 7) uniform usampler2D object;
layout(set = 0, binding = 8) uniform usamplerBuffer materials;
layout(scalar, set = 0, binding = 9) writeonly buffer Mixed { uvec2 mixed[]; };
#define KINO_LOD_OBJECT
#define p push.lod
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
#include "viz/quality/lod_eq1.glsl"
#undef p
#include "viz/light/sample_mean.glsl"

const float kLeastTowards = 0.05;
const int kAround = 9;
const vec2 kSamplePlaces[4] = vec2[](vec2(-0.125, -0.375), vec2(0.375, -0.125),
                                     vec2(-0.375, 0.125), vec2(0.125, 0.375));

vec3 emitted_by(uint object) {
    return kEmission != 0u
               ? uintBitsToFloat(texelFetch(materials, int(3u * (object >> 16) + 1u)).xyz)
               : vec3(0.0);
}
vec3 divisor(vec3 coded) {
    return kFineGrained != 0u ? max(from_srgb(coded), push.least_albedo) : vec3(1.0);
}
// As background.frag has it, in 8 bits.
vec3 backdrop(int y) {
    vec3 color = mix(unpackUnorm4x8(push.background.x).rgb, unpackUnorm4x8(push.background.y).rgb,
                     (float(y) + 0.5) / float(push.lod.fine.y));
    return round(color * 255.0) / 255.0;
}
vec2 slope_of(vec3 n) { return n.xy / max(-n.z, kLeastTowards); }

// Weights of a quadratic B-spline for the three pixels around a place `t` off the middle one.
vec3 spline(float t) {
    return vec3(0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t));
}

// Eq. 1 for each sample of a listed pixel, with the sample's own guides, over the 3x3 pixels of the
// finished picture with one sample; then their mean.
void main() {
    uint entry = gl_GlobalInvocationID.x;
    if (entry >= texelFetch(state, 3).x) return;
    uint word = texelFetch(listed, int(entry)).x;
    ivec2 here = ivec2(word & 0xFFFFu, word >> 16);

    vec3 light[kAround];
    uint objects[kAround];
    CoarseGuides around[3];
    for (int j = 0; j < kAround; ++j) {
        ivec2 at = clamp(here + ivec2(j % 3, j / 3) - 1, ivec2(0), push.lod.last);
        vec3 c = texelFetch(linear, at, 0).rgb;
        vec4 seen = texelFetch(albedo, at, 0);
        float z = texelFetch(view_z, at, 0).r;
        vec2 slope = slope_of(from_octahedral(texelFetch(normal, at, 0).rg));
        objects[j] = texelFetch(object, at, 0).r;
        c = mix(clamp(c, 0.0, 65000.0), vec3(0.0), isnan(c));
        light[j] = (c - emitted_by(objects[j])) / divisor(seen.rgb);
        around[j / 4].x[j % 4] = float(at.x);
        around[j / 4].y[j % 4] = float(at.y);
        around[j / 4].z[j % 4] = is_there(z) ? z : 1.0;
        around[j / 4].nothing[j % 4] = !is_there(z);
        around[j / 4].slope_x[j % 4] = slope.x;
        around[j / 4].slope_y[j % 4] = slope.y;
    }

    vec4 sum = vec4(0.0);
    for (int s = 0; s < 4; ++s) {
        vec4 what = texelFetch(samples, here, s);
        uint own_object = sample_object(what);
        vec3 n = sample_normal(what);
        float z = sample_z(what);
        vec4 seen = is_backdrop(what) ? vec4(backdrop(here.y), 0.0) : sample_albedo(what);
        FineGuide own = FineGuide(vec2(here), is_there(z) ? z : 1.0, n, slope_of(n));
        vec3 across = spline(kSamplePlaces[s].x);
        vec3 down = spline(kSamplePlaces[s].y);
        float e[kAround];
        float least = 1e30;
        for (int j = 0; j < kAround; ++j) around[j / 4].other[j % 4] = objects[j] != own_object;
        for (int k = 0; k < 3; ++k) {
            vec4 four = eq1_exponents(own, around[k]);
            for (int j = 0; j < (k < 2 ? 4 : 1); ++j) {
                e[4 * k + j] = four[j];
                least = min(least, four[j]);
            }
        }
        vec3 mixed_light = vec3(0.0);
        float weights = 0.0;
        for (int j = 0; j < kAround; ++j) {
            float w = across[j % 3] * down[j / 3] * exp2(min(least - e[j], 0.0));
            mixed_light += w * light[j];
            weights += w;
        }
        vec3 lit = mixed_light / weights * divisor(seen.rgb) + emitted_by(own_object);
        bool own_color = kKeepBackground != 0u && seen.a == 0.0;
        vec4 c = vec4(own_color ? from_srgb(seen.rgb) : max(lit, 0.0), seen.a);
        sum += vec4(sample_exposed(c, push.final), c.a);
    }
    vec4 mean = mean_of_samples(sum, 4u, push.final);
    mixed[entry] = uvec2(packHalf2x16(mean.rg), packHalf2x16(mean.ba));
}
