// Lights of a tile, for any fragment shader that shades a surface. The includer declares
//   uniform usamplerBuffer lights, headers, indices   (word_quads, word_pairs, words)
// and, with kShadows, uniform usamplerBuffer shadow_masks, and walks the slots
//   0 .. slots_of(tile) - 1. Which parts are compiled is up to the specialisation constants.
#ifndef KINO_FIRST_LIGHT_CONSTANT
#define KINO_FIRST_LIGHT_CONSTANT 0
#endif
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT) const uint kLists = 1u;    // 0: all local lights
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 1) const uint kGlobals = 0u;  // 1: directional lights first
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 2) const uint kSpots = 0u;
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 3) const uint kMasks = 0u;
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 4) const uint kShadows = 0u;

struct TileList {
    uint first;
    uint count;
};

TileList list_at(vec2 pixel_center) {
    TileList list = TileList(p.globals, p.locals);
    if (kLists != 0u) {
        uvec2 tile = uvec2(pixel_center * p.tile_scale);
        uvec2 header = texelFetch(headers, int(tile.y * p.tiles_x + tile.x)).xy;
        list = TileList(header.x, header.y);
    }
    return list;
}

uint light_in(TileList list, uint entry) {
    return kLists != 0u ? texelFetch(indices, int(list.first + entry)).x : list.first + entry;
}

// 1 where the light in a slot counts for a pixel, else 0.
float unmasked(uint light, uint slot, uint material, uint pixel) {
    float counts = 1.0;
    if (kMasks != 0u || kShadows != 0u) {
        uvec4 extra = texelFetch(lights, int(light * 4u + 3u));
        if (kMasks != 0u) counts = float(extra.y >> material & 1u);
        if (kShadows != 0u) {
            uint word = texelFetch(shadow_masks, int(pixel * 4u + min(slot >> 5u, 3u))).x;
            bool hidden = extra.z != 0u && slot < 128u && (word >> (slot & 31u) & 1u) != 0u;
            counts = hidden ? 0.0 : counts;
        }
    }
    return counts;
}

// Light that arrives at q, without its angle to the surface; `to_light` has unit length. Exactly 0
// from the radius on and outside of a spot's cone. The shape is that of viz/light/shade.glsl.
vec3 local_light(uint light, vec3 q, out vec3 to_light) {
    vec4 place = uintBitsToFloat(texelFetch(lights, int(light * 4u)));
    vec4 color = uintBitsToFloat(texelFetch(lights, int(light * 4u + 1u)));
    vec3 way = place.xyz - q;
    float squared = max(dot(way, way), 1e-6);
    to_light = way * inversesqrt(squared);
    float ratio = squared / (color.w * color.w);
    float inside = clamp(1.0 - ratio * ratio, 0.0, 1.0);
    float falloff = inside * inside / max(squared, 0.01);
    if (kSpots != 0u) {
        vec4 cone = uintBitsToFloat(texelFetch(lights, int(light * 4u + 2u)));
        float scale = uintBitsToFloat(texelFetch(lights, int(light * 4u + 3u)).x);
        float bright = clamp((-dot(to_light, cone.xyz) - cone.w) * scale, 0.0, 1.0);
        uint kind = floatBitsToUint(place.w);
        falloff *= kind == 2u ? bright * bright : kind == 3u ? bright : 1.0;
    }
    return color.rgb * falloff;
}

vec3 global_light(uint light, out vec3 to_light) {
    to_light = uintBitsToFloat(texelFetch(lights, int(light * 4u)).xyz);
    return uintBitsToFloat(texelFetch(lights, int(light * 4u + 1u)).xyz);
}
