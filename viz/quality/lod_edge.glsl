#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
layout(push_constant, scalar) uniform Push { LodParams p; };
layout(constant_id = 0) const uint kFineGrained = 1;
layout(constant_id = 1) const uint kKeepBackground = 1;
layout(constant_id = 2) const uint kMetric = 2;  // RangeMetric
layout(set = 0, binding = 1) uniform sampler2D coarse_light;
layout(set = 0, binding = 2) uniform usampler2D coarse_guide;
layout(set = 0, binding = 3) uniform sampler2D albedo;
layout(set = 0, binding = 4) uniform sampler2D view_z;
layout(set = 0, binding = 5) uniform sampler2D normal;
#ifdef KINO_LOD_OBJECT
#include "viz/quality/lod_object.glsl"
layout(set = 0, binding = 6) uniform usampler2D object;
#endif
layout(constant_id = 3) const uint kDoubt = 0u;
layout(location = 0) out vec4 out_linear;
layout(location = 1) out float out_doubt;

// Eq. 1 of Yang, Sander, Lawrence 2008 with the packed coarse picture.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    ivec2 corner[4] = ivec2[](at.a, ivec2(at.b.x, at.a.y), ivec2(at.a.x, at.b.y), at.b);
    float z = texelFetch(view_z, here, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, here, 0).rg);
    bool there = is_there(z);
    z = there ? z : 1.0;

    vec4 lit[4];
    for (int j = 0; j < 4; ++j) lit[j] = texelFetch(coarse_light, corner[j], 0);
    uvec4 guide;
    for (int j = 0; j < 4; ++j) guide[j] = texelFetch(coarse_guide, corner[j], 0).r;
    vec4 steps = vec4(guide >> 16);
    vec4 d;
    if (kMetric == 1u) {
        // ln z_j - ln z_i
        d = (steps - (1.0 + (log2(z) - kGuideNearLog2) * kGuideStepsPerOctave)) *
            (0.69314718 / kGuideStepsPerOctave);
    } else {
        vec4 ratio =
            exp2((steps - 1.0) * (1.0 / kGuideStepsPerOctave) + kGuideNearLog2) / z;  // z_j / z_i
        d = (1.0 - ratio) * z;
        if (kMetric == 2u) {
            // n_i . (P_i - P_j) / z_i
            vec2 place_a = ((vec2(at.a) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy - p.fine_k.zw) *
                           p.fine_k.xy;
            vec2 place_b = ((vec2(at.b) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy - p.fine_k.zw) *
                           p.fine_k.xy;
            vec2 along_a = n.xy * place_a;
            vec2 along_b = n.xy * place_b;
            vec4 along = vec4(along_a.x + along_a.y, along_b.x + along_a.y, along_a.x + along_b.y,
                              along_b.x + along_b.y) + n.z;
            vec2 own = n.xy * (vec2(here) - p.fine_k.zw) * p.fine_k.xy;
            d = (own.x + own.y + n.z) - along * ratio;
        }
    }
    vec2 slope = n.xy / max(-n.z, kGuideLeastTowards) * kGuideNormalSteps + 128.0;
    vec4 dx = vec4(guide & 255u) - slope.x;
    vec4 dy = vec4((guide >> 8) & 255u) - slope.y;
    vec4 e = min(d * d * p.z_weight, kFarthest);
    if (kKeepBackground != 0u) e = mix(e, vec4(kNothing), lessThan(steps, vec4(0.5)));
    e += (dx * dx + dy * dy) * (p.n_weight / (kGuideNormalSteps * kGuideNormalSteps));
#ifdef KINO_LOD_OBJECT
    vec4 tags = vec4(lit[0].a, lit[1].a, lit[2].a, lit[3].a);
    float own_tag = object_tag(texelFetch(object, here, 0).r);
    e += mix(vec4(kOtherObject), vec4(0.0), equal(tags, vec4(own_tag)));
#endif
    vec4 w = range_weights(e, tent(at.t));

    vec3 light = vec3(0.0);
    for (int j = 0; j < 4; ++j) light += w[j] * lit[j].rgb;
    light /= w.x + w.y + w.z + w.w;
    vec4 seen = texelFetch(albedo, here, 0);
    vec3 own = from_srgb(seen.rgb);
    if (kFineGrained != 0u) light *= own;
    if (kKeepBackground != 0u && seen.a == 0.0) light = own;
    out_linear = vec4(light, seen.a);
    if (kDoubt != 0u) {
        bool own_color = kKeepBackground != 0u && seen.a == 0.0;
        out_doubt = own_color ? 0.0 : doubt_of(e, tent(at.t));
    }
}
