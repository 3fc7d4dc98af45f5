// What the passes of ray-cast shadows share: the place of a texel, and which of the tile's lights
// want a ray from there. Nothing may be contracted: the processor counts the same rays.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/shadow_shared.h"
#include "viz/surface/octahedral.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { ShadowParams p; };
layout(set = 0, binding = 0) uniform sampler2D view_z;
layout(set = 0, binding = 1) uniform sampler2D normal;
layout(set = 0, binding = 2) uniform usamplerBuffer lights;   // word_quads
layout(set = 0, binding = 3) uniform usamplerBuffer headers;  // word_pairs
layout(set = 0, binding = 4) uniform usamplerBuffer indices;  // words
layout(constant_id = 0) const uint kLists = 1u;  // 0: all local lights
layout(constant_id = 1) const uint kHalf = 1u;   // a texel is 2 x 2 pixels
layout(constant_id = 2) const uint kSpots = 1u;
const uint kMostSlots = 128u;

struct Place {
    vec3 at;      // view space
    vec3 normal;  // view space
    bool there;
};

// The first covered pixel of a texel stands for it.
ivec2 pixel_of(uvec2 texel) {
    ivec2 first = ivec2(texel) * (kHalf != 0u ? 2 : 1);
    ivec2 chosen = first;
    bool found = kHalf == 0u;
    for (int i = 0; i < (found ? 0 : 4); ++i) {
        ivec2 at = first + ivec2(i & 1, i >> 1);
        ivec2 inside = min(at, ivec2(p.size) - 1);
        bool covered = at == inside && texelFetch(view_z, inside, 0).r > 0.0;
        chosen = covered && !found ? at : chosen;
        found = found || covered;
    }
    return chosen;
}

Place place_of(ivec2 pixel) {
    float z = texelFetch(view_z, pixel, 0).r;
    precise vec2 ray = (vec2(pixel) - p.k.zw) * p.k.xy;
    precise vec3 at = vec3(ray * z, z);
    return Place(at, from_octahedral(texelFetch(normal, pixel, 0).rg), z > 0.0);
}

struct Slots {
    uint first;  // index of the first local one, or where the list begins
    uint count;  // global lights included
};

Slots slots_of(ivec2 pixel) {
    Slots slots = Slots(p.globals, p.globals + p.locals);
    if (kLists != 0u) {
        uvec2 tile = uvec2((vec2(pixel) + 0.5) * p.tile_scale);
        uvec2 header = texelFetch(headers, int(tile.y * p.tiles_x + tile.x)).xy;
        slots = Slots(header.x, p.globals + header.y);
    }
    return slots;
}

uint light_in(Slots slots, uint slot) {
    uint entry = slots.first + slot - p.globals;
    uint local = kLists != 0u && slot >= p.globals ? texelFetch(indices, int(entry)).x : entry;
    return slot < p.globals ? slot : local;
}

// The way to the light; true where the light would reach the place if nothing stood between.
bool wants_ray(uint light, Place place, out vec3 way) {
    uvec4 first = texelFetch(lights, int(4u * light));
    float radius = uintBitsToFloat(texelFetch(lights, int(4u * light + 1u)).w);
    bool casts = texelFetch(lights, int(4u * light + 3u)).z != 0u;
    bool directional = first.w == 0u;
    vec3 source = uintBitsToFloat(first.xyz);
    precise vec3 to_light = source - place.at;
    way = directional ? source : to_light;
    precise float squared = way.x * way.x + way.y * way.y + way.z * way.z;
    precise float towards =
        way.x * place.normal.x + way.y * place.normal.y + way.z * place.normal.z;
    precise float reach = radius * radius;
    bool lit = casts && towards > 0.0 && (directional || squared < reach);
    if (kSpots != 0u) {
        vec4 cone = uintBitsToFloat(texelFetch(lights, int(4u * light + 2u)));
        precise float along = -(way.x * cone.x + way.y * cone.y + way.z * cone.z);
        precise float edge = cone.w * sqrt(squared);
        lit = lit && (first.w != 2u || along > edge);
    }
    return lit;
}
