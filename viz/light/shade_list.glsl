// Listed pixels by compute: what shade_materials.frag and, with KINO_LIST_LIVE, shade_live.frag do.
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/light/color.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { ListShadeParams p; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(set = 0, binding = 3) uniform usamplerBuffer lights;
layout(set = 0, binding = 4) uniform usamplerBuffer headers;
layout(set = 0, binding = 5) uniform usamplerBuffer indices;
layout(set = 0, binding = 6) uniform usamplerBuffer shadow_masks;
layout(set = 0, binding = 7) uniform usamplerBuffer listed;
layout(set = 0, binding = 8) uniform usamplerBuffer state;
layout(set = 0, binding = 9, rgba16f) uniform writeonly image2D linear;
#include "viz/light/light_loop.glsl"
#ifdef KINO_LIST_LIVE
layout(constant_id = 5) const uint kMixed = 0u;
#include "viz/light/shade_part.glsl"
#else
layout(set = 0, binding = 10) uniform usampler2D object;
layout(set = 0, binding = 11) uniform usamplerBuffer materials;
layout(set = 0, binding = 12) uniform usamplerBuffer lobes;
#include "viz/light/shade_surface.glsl"
#endif

void main() {
    uint entry = gl_GlobalInvocationID.x;
    bool wanted = entry < texelFetch(state, 3).x;
    entry = wanted ? entry : 0u;  // whose result nobody stores
    uint word = texelFetch(listed, int(entry)).x;
    ivec2 at = ivec2(word & 0xFFFFu, word >> 16);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 base = from_srgb(seen.rgb);
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 q = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * texelFetch(view_z, at, 0).r;
    bool there = seen.a > 0.0;
    TileList list = list_at(vec2(at) + 0.5);
    if (!wanted || !there) list.count = 0u;
#ifdef KINO_LIST_LIVE
    vec3 irradiance = own_light(kMixed != 0u ? vec3(1.0) : p.ambient);
    vec3 l;
    if (kGlobals != 0u) {
        for (uint i = 0u; i < p.globals; ++i) {
            vec3 light = global_light(i, l);
            irradiance += light * (max(dot(n, l), 0.0) * unmasked(i, i, 0u, entry));
        }
    }
    for (uint k = 0u; k < list.count; ++k) {
        uint i = light_in(list, k);
        vec3 light = local_light(i, q, l);
        irradiance += light * (max(dot(n, l), 0.0) * unmasked(i, p.globals + k, 0u, entry));
    }
    vec3 light = base * irradiance;
#else
    Surface s = Surface(base, q, n, texelFetch(object, at, 0).r >> 16u);
    vec3 light = shade(s, list, entry);
#endif
    if (wanted) imageStore(linear, at, vec4(there ? light : base, seen.a));
}
