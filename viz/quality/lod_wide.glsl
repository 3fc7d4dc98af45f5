#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
layout(push_constant, scalar) uniform Push { LodParams p; };
layout(constant_id = 0) const uint kFineGrained = 1;
layout(constant_id = 1) const uint kKeepBackground = 1;
layout(constant_id = 2) const uint kMetric = 2;  // RangeMetric
layout(set = 0, binding = 0) uniform sampler2D coarse_linear;
layout(set = 0, binding = 1) uniform sampler2D coarse_albedo;
layout(set = 0, binding = 2) uniform sampler2D coarse_view_z;
layout(set = 0, binding = 3) uniform sampler2D coarse_normal;
layout(set = 0, binding = 4) uniform sampler2D albedo;
layout(set = 0, binding = 5) uniform sampler2D view_z;
layout(set = 0, binding = 6) uniform sampler2D normal;
#ifdef KINO_LOD_OBJECT
layout(set = 0, binding = 7) uniform usampler2D coarse_object;
layout(set = 0, binding = 8) uniform usampler2D object;
#endif
layout(constant_id = 3) const uint kDoubt = 0u;
layout(location = 0) out vec4 out_linear;
layout(location = 1) out float out_doubt;

const float kLeastTowards = 0.05;

vec3 at_distance(vec2 pixel) {
    return vec3((pixel - p.fine_k.zw) * p.fine_k.xy, 1.0);
}

// Eq. 1 with guides and colours as they are: what the packed kernel is measured against.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    ivec2 corner[4] = ivec2[](at.a, ivec2(at.b.x, at.a.y), ivec2(at.a.x, at.b.y), at.b);
    float z = texelFetch(view_z, here, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, here, 0).rg);
    z = is_there(z) ? z : 1.0;
    vec2 slope = n.xy / max(-n.z, kLeastTowards);
    vec3 place = at_distance(vec2(here)) * z;

    vec4 e;
    vec3 light[4];
    for (int j = 0; j < 4; ++j) {
        float zj = texelFetch(coarse_view_z, corner[j], 0).r;
        bool nothing = !is_there(zj);
        zj = nothing ? 1.0 : zj;
        vec3 nj = from_octahedral(texelFetch(coarse_normal, corner[j], 0).rg);
        float d = z - zj;
        if (kMetric == 1u) d = log(z) - log(zj);
        if (kMetric == 2u) {
            vec2 pixel = (vec2(corner[j]) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy;
            d = dot(n, place - at_distance(pixel) * zj) / z;
        }
        vec2 apart = slope - nj.xy / max(-nj.z, kLeastTowards);
        e[j] = kKeepBackground != 0u && nothing ? kNothing : min(d * d * p.z_weight, kFarthest);
        e[j] += dot(apart, apart) * p.n_weight;
#ifdef KINO_LOD_OBJECT
        if (texelFetch(coarse_object, corner[j], 0).r != texelFetch(object, here, 0).r) e[j] += kOtherObject;
#endif
        light[j] = finite_light(texelFetch(coarse_linear, corner[j], 0).rgb);
        if (kFineGrained != 0u) {
            light[j] /= max(from_srgb(texelFetch(coarse_albedo, corner[j], 0).rgb), 1e-3);
        }
    }
    vec4 w = range_weights(e, tent(at.t));
    vec3 sum = w.x * light[0] + w.y * light[1] + w.z * light[2] + w.w * light[3];
    sum /= w.x + w.y + w.z + w.w;
    vec4 seen = texelFetch(albedo, here, 0);
    vec3 own = from_srgb(seen.rgb);
    if (kFineGrained != 0u) sum *= own;
    if (kKeepBackground != 0u && seen.a == 0.0) sum = own;
    out_linear = vec4(sum, seen.a);
    if (kDoubt != 0u) {
        bool own_color = kKeepBackground != 0u && seen.a == 0.0;
        out_doubt = own_color ? 0.0 : doubt_of(e, tent(at.t));
    }
}
