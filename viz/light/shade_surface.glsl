// shade(Surface, TileList): layered materials under all lights of a tile. The includer has declared
// what viz/light/light_loop.glsl wants, and uniform usamplerBuffer materials, lobes (word_quads).
#include "viz/light/lobes.glsl"
#include "viz/light/shade_part.glsl"
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 7) const uint kEmission = 1u;
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 5) const uint kColorMode = 2u;  // as ColorMode

struct Surface {
    vec3 base;    // linear
    vec3 place;   // view space
    vec3 normal;  // view space, unit length
    uint material;
};

Lobe lobe_at(uint i) {
    vec4 a = uintBitsToFloat(texelFetch(lobes, int(2u * i)));
    vec4 b = uintBitsToFloat(texelFetch(lobes, int(2u * i + 1u)));
    return Lobe(a.rgb, floatBitsToUint(a.w), b.rgb, b.w);
}

vec3 shade(Surface s, TileList list, uint pixel) {
    uvec4 m0 = texelFetch(materials, int(3u * s.material));
    uvec4 m1 = texelFetch(materials, int(3u * s.material + 1u));
    vec3 ambient = uintBitsToFloat(texelFetch(materials, int(3u * s.material + 2u)).xyz);
    vec3 v = -normalize(s.place);
    uint lobe_count = m1.w;
    bool live = s.material == 0u;
    vec3 diffuse = vec3(0.0);
    vec3 rest = vec3(0.0);
    // Captured pictures stay what they are beside meshes that are lit.
    bool untouched = kColorMode == 0u && live;
    vec3 l;
    if (kGlobals != 0u) {
        for (uint i = 0u; i < p.globals; ++i) {
            vec3 light = global_light(i, l) * unmasked(i, i, s.material, pixel);
            float towards = untouched ? 0.0 : max(dot(s.normal, l), 0.0);
            diffuse += light * towards;
            if (kLobeKinds != 0u) {
                for (uint k = 0u; k < lobe_count; ++k) {
                    rest += light * lobe_light(lobe_at(m0.w + k), s.base, s.normal, v, l, towards);
                }
            }
        }
    }
    uint count = untouched ? 0u : list.count;
    for (uint j = 0u; j < count; ++j) {
        uint i = light_in(list, j);
        vec3 light = local_light(i, s.place, l) * unmasked(i, p.globals + j, s.material, pixel);
        float towards = max(dot(s.normal, l), 0.0);
        diffuse += light * towards;
        if (kLobeKinds != 0u) {
            for (uint k = 0u; k < lobe_count; ++k) {
                rest += light * lobe_light(lobe_at(m0.w + k), s.base, s.normal, v, l, towards);
            }
        }
    }
    vec3 already = own_light(live && kColorMode != 2u ? vec3(1.0) : p.ambient * ambient);
    vec3 emitted = kEmission != 0u ? uintBitsToFloat(m1.xyz) : vec3(0.0);
    return s.base * (already + diffuse * uintBitsToFloat(m0.xyz)) + rest + emitted;
}
