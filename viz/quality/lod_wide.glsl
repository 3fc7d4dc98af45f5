#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
#include "viz/light/final_color.glsl"
layout(push_constant, scalar) uniform Push {
    LodParams p;
    FinalParams final_params;
};
#include "viz/quality/lod_constants.glsl"
#include "viz/quality/lod_eq1.glsl"
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

const float kLeastTowards = 0.05;

// Four coarse pixels as they are, and their light.
CoarseGuides wide_guides(ivec4 x, ivec4 y, uint own_object, out vec3 light[4]) {
    CoarseGuides around;
    around.x = vec4(x);
    around.y = vec4(y);
    for (int j = 0; j < 4; ++j) {
        ivec2 corner = ivec2(x[j], y[j]);
        float zj = texelFetch(coarse_view_z, corner, 0).r;
        vec3 nj = from_octahedral(texelFetch(coarse_normal, corner, 0).rg);
        vec2 slope = nj.xy / max(-nj.z, kLeastTowards);
        around.nothing[j] = !is_there(zj);
        around.z[j] = is_there(zj) ? zj : 1.0;
        around.slope_x[j] = slope.x;
        around.slope_y[j] = slope.y;
        around.other[j] = false;
#ifdef KINO_LOD_OBJECT
        around.other[j] = texelFetch(coarse_object, corner, 0).r != own_object;
#endif
        light[j] = finite_light(texelFetch(coarse_linear, corner, 0).rgb);
        if (kFineGrained != 0u) {
            light[j] /= max(from_srgb(texelFetch(coarse_albedo, corner, 0).rgb), 1e-3);
        }
    }
    return around;
}

// Eq. 1 with guides and colours as they are: what the packed kernel is measured against.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float z = texelFetch(view_z, here, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, here, 0).rg);
    FineGuide i = FineGuide(vec2(here), is_there(z) ? z : 1.0, n, n.xy / max(-n.z, kLeastTowards));
    uint own_object = 0u;
#ifdef KINO_LOD_OBJECT
    own_object = texelFetch(object, here, 0).r;
#endif
    Footprint at = footprint_of(i.place, p.coarse_of_fine, p.last);
    Footprint4 at4 = footprint4_of(i.place, p.coarse_of_fine, p.last);
    const int kGroups = kKernel == 0u ? 1 : 4;
    vec4 e[4];
    vec4 f[4];
    vec3 light[4][4];
    float least = 1e30;
    for (int k = 0; k < kGroups; ++k) {
        ivec4 x = kKernel == 0u ? ivec4(at.a.x, at.b.x, at.a.x, at.b.x) : at4.x;
        ivec4 y = kKernel == 0u ? ivec4(at.a.y, at.a.y, at.b.y, at.b.y) : ivec4(at4.y[k]);
        f[k] = kKernel == 0u ? tent(at.t) : at4.fx * at4.fy[k];
        e[k] = eq1_exponents(i, wide_guides(x, y, own_object, light[k]));
        least = min(least, least_counting(e[k], f[k]));
    }
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int k = 0; k < kGroups; ++k) {
        vec4 w = f[k] * exp2(min(least - e[k], 0.0));
        for (int j = 0; j < 4; ++j) sum += w[j] * light[k][j];
        weights += w.x + w.y + w.z + w.w;
    }
    put(sum / weights, texelFetch(albedo, here, 0), least - log2(weights));
}
