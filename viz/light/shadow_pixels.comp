#version 460
#include "viz/light/shadow_head.glsl"
// One lane a texel, which walks its tile's lights and traces as it goes. Neighbouring lanes have
// the same lights at the same time, so their rays keep together.
layout(set = 0, binding = 5) uniform usamplerBuffer bvh_nodes;
layout(set = 0, binding = 6) uniform usamplerBuffer bvh_triangles;
layout(scalar, set = 0, binding = 7) writeonly buffer Masks { uvec4 masks[]; };
layout(scalar, set = 0, binding = 8) buffer Counters { ShadowCounters counters; };
#define KINO_LIVE_BINDING 9
#include "viz/light/shadow_ray.glsl"

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    bool inside = texel.x < p.texels.x;
    texel.x = min(texel.x, p.texels.x - 1u);
    ivec2 pixel = pixel_of(texel);
    Place place = place_of(pixel);
    Slots slots = slots_of(pixel);
    uint count = inside && place.there ? min(slots.count, kMostSlots) : 0u;
    uvec4 mask = uvec4(0u);
    uint rays = 0u;
    uint capped = 0u;
    for (uint slot = 0u; slot < count; ++slot) {
        uint light = light_in(slots, slot);
        vec3 way;
        bool wanted = wants_ray(light, place, way);
        bool traced = wanted && rays < p.most_rays;
        bool directional = slot < p.globals;
        uint bit = hidden(place, way, directional, traced) ? 1u << (slot & 31u) : 0u;
        uvec4 word = uvec4(equal(uvec4(slot >> 5u), uvec4(0u, 1u, 2u, 3u)));
        mask |= word * bit;
        rays += traced ? 1u : 0u;
        capped += wanted && !traced ? 1u : 0u;
    }
    for (uint k = 0u; k < (rays > 0u ? 1u : 0u); ++k) atomicAdd(counters.jobs, rays);
    for (uint k = 0u; k < (capped > 0u ? 1u : 0u); ++k) atomicAdd(counters.capped, capped);
    if (inside) masks[texel.y * p.texels.x + texel.x] = mask;
}
