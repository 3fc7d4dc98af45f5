#version 460
#include "viz/light/shadow_head.glsl"
// One lane a texel of the band: a job for each ray that it wants, texel and slot in one word. A
// lane reserves room for all of its jobs at once.
layout(scalar, set = 0, binding = 5) writeonly buffer Jobs { uint jobs[]; };
layout(scalar, set = 0, binding = 6) buffer Counters { ShadowCounters counters; };

void main() {
    uvec2 texel = gl_GlobalInvocationID.xy;
    texel.y += p.first_row;
    bool inside = texel.x < p.texels.x;
    texel.x = min(texel.x, p.texels.x - 1u);
    ivec2 pixel = pixel_of(texel);
    Place place = place_of(pixel);
    Slots slots = slots_of(pixel);
    uint count = inside && place.there ? min(slots.count, kMostSlots) : 0u;
    uvec4 wanted = uvec4(0u);
    uint rays = 0u;
    uint capped = 0u;
    for (uint slot = 0u; slot < count; ++slot) {
        vec3 way;
        bool wants = wants_ray(light_in(slots, slot), place, way);
        bool traced = wants && rays < p.most_rays;
        uvec4 word = uvec4(equal(uvec4(slot >> 5u), uvec4(0u, 1u, 2u, 3u)));
        wanted |= word * (traced ? 1u << (slot & 31u) : 0u);
        rays += traced ? 1u : 0u;
        capped += wants && !traced ? 1u : 0u;
    }
    uint place_in_list = 0u;
    for (uint k = 0u; k < (rays > 0u ? 1u : 0u); ++k) {
        atomicAdd(counters.jobs, rays);
        place_in_list = atomicAdd(counters.band_jobs, rays);
        atomicMax(counters.groups_x, (place_in_list + rays + 63u) / 64u);
    }
    for (uint k = 0u; k < (capped > 0u ? 1u : 0u); ++k) atomicAdd(counters.capped, capped);
    uint texel_index = texel.y * p.texels.x + texel.x;
    for (uint written = 0u; written < rays; ++written) {
        uint word = wanted.x != 0u ? 0u : (wanted.y != 0u ? 1u : (wanted.z != 0u ? 2u : 3u));
        uint bits = wanted[word];
        uint slot = 32u * word + uint(findLSB(bits));
        wanted[word] = bits & (bits - 1u);
        jobs[place_in_list + written] = (texel_index << 7u) | slot;
    }
}
