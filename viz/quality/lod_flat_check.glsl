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
layout(location = 0) out vec4 out_linear;
layout(location = 1) out float out_doubt;

// A flat tile whose pixels may show what no coarse pixel saw: light as lod_flat.frag makes it, and
// the doubt by one coarse pixel, as all are of one surface.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    vec4 f = tent(at.t);
    vec4 at_a = texelFetch(coarse_light, at.a, 0);
    vec3 light = f.x * at_a.rgb +
                 f.y * texelFetch(coarse_light, ivec2(at.b.x, at.a.y), 0).rgb +
                 f.z * texelFetch(coarse_light, ivec2(at.a.x, at.b.y), 0).rgb +
                 f.w * texelFetch(coarse_light, at.b, 0).rgb;
    vec4 seen = texelFetch(albedo, here, 0);
    vec3 own = from_srgb(seen.rgb);
    bool own_color = kKeepBackground != 0u && seen.a == 0.0;
    if (kFineGrained != 0u) light *= own;
    out_linear = vec4(own_color ? own : light, seen.a);

    ivec2 nearest = ivec2(at.t.x < 0.5 ? at.a.x : at.b.x, at.t.y < 0.5 ? at.a.y : at.b.y);
    uint guide = texelFetch(coarse_guide, nearest, 0).r;
    float steps = float(guide >> 16);
    float z = texelFetch(view_z, here, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, here, 0).rg);
    z = is_there(z) ? z : 1.0;
    float ratio = exp2((steps - 1.0) * (1.0 / kGuideStepsPerOctave) + kGuideNearLog2) / z;
    float d = kMetric == 1u ? log2(ratio) * 0.69314718 : (1.0 - ratio) * z;
    if (kMetric == 2u) {
        vec2 place = (vec2(nearest) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy;
        vec3 ray = vec3((vec2(here) - p.fine_k.zw) * p.fine_k.xy, 1.0);
        vec3 other = vec3((place - p.fine_k.zw) * p.fine_k.xy, 1.0);
        d = dot(n, ray) - dot(n, other) * ratio;
    }
    vec2 slope = n.xy / max(-n.z, kGuideLeastTowards) * kGuideNormalSteps + 128.0;
    vec2 apart = (vec2(guide & 255u, (guide >> 8) & 255u) - slope) / kGuideNormalSteps;
    float e = min(d * d * p.z_weight, kFarthest);
    if (kKeepBackground != 0u && steps < 0.5) e = kNothing;
    e += dot(apart, apart) * p.n_weight;
#ifdef KINO_LOD_OBJECT
    // All four have one object, or the tile were not flat.
    e += object_tag(texelFetch(object, here, 0).r) == at_a.a ? 0.0 : kOtherObject;
#endif
    out_doubt = own_color ? 0.0 : doubt_of(vec4(e), vec4(0.25));
}
