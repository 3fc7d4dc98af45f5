#version 460
#include "viz/light/shadow_head.glsl"
// Listed pixels only, a lane each: their masks, in the order of the list.
layout(set = 0, binding = 5) uniform usamplerBuffer bvh_nodes;
layout(set = 0, binding = 6) uniform usamplerBuffer bvh_triangles;
layout(scalar, set = 0, binding = 7) writeonly buffer Masks { uvec4 masks[]; };
layout(set = 0, binding = 8) uniform usamplerBuffer listed;
#define KINO_LIVE_BINDING 9
layout(set = 0, binding = 11) uniform usamplerBuffer state;
#include "viz/light/shadow_ray.glsl"

void main() {
    uint entry = gl_GlobalInvocationID.x;
    bool wanted_at_all = entry < texelFetch(state, 3).x;
    uint word = texelFetch(listed, wanted_at_all ? int(entry) : 0).x;
    ivec2 pixel = ivec2(word & 0xFFFFu, word >> 16);
    Place place = place_of(pixel);
    Slots slots = slots_of(pixel);
    uint count = wanted_at_all && place.there ? min(slots.count, kMostSlots) : 0u;
    uvec4 mask = uvec4(0u);
    uint rays = 0u;
    for (uint slot = 0u; slot < count; ++slot) {
        vec3 way;
        bool traced = wants_ray(light_in(slots, slot), place, way) && rays < p.most_rays;
        uint bit = hidden(place, way, slot < p.globals, traced) ? 1u << (slot & 31u) : 0u;
        mask |= uvec4(equal(uvec4(slot >> 5u), uvec4(0u, 1u, 2u, 3u))) * bit;
        rays += traced ? 1u : 0u;
    }
    if (wanted_at_all) masks[entry] = mask;
}
