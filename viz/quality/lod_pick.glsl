#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_guide.glsl"
layout(push_constant, scalar) uniform Push { LodPickParams p; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
#ifdef KINO_LOD_OBJECT
layout(set = 0, binding = 3) uniform usampler2D object;
layout(location = 3) out uint out_object;
layout(location = 4) out uint out_guide;
#else
layout(location = 3) out uint out_guide;
#endif
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out float out_view_z;
layout(location = 2) out vec2 out_normal;

// floor((at + 1/2) fine / coarse), exactly: a quotient in floats, one off at most, and what is left
// over says which way. CPU devices divide whole numbers one lane at a time.
ivec2 fine_texel(uvec2 at) {
    ivec2 above = ivec2((2u * at + 1u) * p.fine);
    ivec2 below = ivec2(2u * p.coarse);
    ivec2 q = ivec2(vec2(above) / vec2(below));
    ivec2 left = above - q * below;
    q -= ivec2(lessThan(left, ivec2(0)));
    return q + ivec2(greaterThanEqual(left, below));
}

// One fine texel for each coarse one, the nearest: guides are never averaged.
void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    ivec2 from = fine_texel(at);
    float z = texelFetch(view_z, from, 0).r;
    vec2 packed_normal = texelFetch(normal, from, 0).rg;
    vec3 n = from_octahedral(packed_normal);
    bool there = is_there(z);

    // The coarse pixel's centre may lie up to half a fine pixel off the texel: the depth follows
    // the texel's own plane to where the coarse pixel's ray meets it.
    vec3 fine_ray = vec3((vec2(from) - p.fine_k.zw) * p.fine_k.xy, 1.0);
    vec3 coarse_ray = vec3((vec2(at) - p.coarse_k.zw) * p.coarse_k.xy, 1.0);
    float ratio = dot(n, fine_ray) / dot(n, coarse_ray);
    z = there && abs(ratio - 1.0) < 0.02 ? z * ratio : z;

    vec4 color = texelFetch(albedo, from, 0);
    out_albedo = vec4(max(color.rgb, p.least_albedo), color.a);
    out_view_z = there ? z : 0.0;
    out_normal = packed_normal;
    out_guide = guide_word(z, n, there);
#ifdef KINO_LOD_OBJECT
    out_object = texelFetch(object, from, 0).r;
#endif
}
