#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
layout(push_constant, scalar) uniform Push { LodParams p; };
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

// Eq. 1 with guides and colours as they are: what the packed kernel is measured against.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    ivec2 corner[4] = ivec2[](at.a, ivec2(at.b.x, at.a.y), ivec2(at.a.x, at.b.y), at.b);
    float z = texelFetch(view_z, here, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, here, 0).rg);
    FineGuide i =
        FineGuide(vec2(here), is_there(z) ? z : 1.0, n, n.xy / max(-n.z, kLeastTowards));
    CoarseGuides around;
    vec3 light[4];
    for (int j = 0; j < 4; ++j) {
        float zj = texelFetch(coarse_view_z, corner[j], 0).r;
        vec3 nj = from_octahedral(texelFetch(coarse_normal, corner[j], 0).rg);
        vec2 slope = nj.xy / max(-nj.z, kLeastTowards);
        around.x[j] = float(corner[j].x);
        around.y[j] = float(corner[j].y);
        around.nothing[j] = !is_there(zj);
        around.z[j] = is_there(zj) ? zj : 1.0;
        around.slope_x[j] = slope.x;
        around.slope_y[j] = slope.y;
        around.other[j] = false;
#ifdef KINO_LOD_OBJECT
        around.other[j] =
            texelFetch(coarse_object, corner[j], 0).r != texelFetch(object, here, 0).r;
#endif
        light[j] = finite_light(texelFetch(coarse_linear, corner[j], 0).rgb);
        if (kFineGrained != 0u) {
            light[j] /= max(from_srgb(texelFetch(coarse_albedo, corner[j], 0).rgb), 1e-3);
        }
    }
    vec4 e = eq1_exponents(i, around);
    vec4 w = range_weights(e, tent(at.t));
    vec3 sum = w.x * light[0] + w.y * light[1] + w.z * light[2] + w.w * light[3];
    put(sum / (w.x + w.y + w.z + w.w), texelFetch(albedo, here, 0), e, tent(at.t));
}
