#version 460
#include "viz/light/shadow_head.glsl"
// One lane a job: a ray, and a bit if it meets something.
layout(set = 0, binding = 5) uniform usamplerBuffer bvh_nodes;
layout(set = 0, binding = 6) uniform usamplerBuffer bvh_triangles;
layout(set = 0, binding = 7) uniform usamplerBuffer jobs;  // words
layout(scalar, set = 0, binding = 8) readonly buffer Counters { ShadowCounters counters; };
layout(scalar, set = 0, binding = 9) buffer Masks { uint masks[]; };
#define KINO_LIVE_BINDING 10
#include "viz/light/shadow_ray.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    bool is_job = i < counters.band_jobs;
    uint job = texelFetch(jobs, int(is_job ? i : 0u)).x;
    uint texel_index = job >> 7u;
    uint slot = job & 127u;
    uvec2 texel = uvec2(texel_index % p.texels.x, texel_index / p.texels.x);
    ivec2 pixel = pixel_of(texel);
    Place place = place_of(pixel);
    vec3 way;
    bool wanted = wants_ray(light_in(slots_of(pixel), slot), place, way);
    bool found = hidden(place, way, slot < p.globals, is_job && wanted);
    for (uint k = 0u; k < (found ? 1u : 0u); ++k) {
        atomicOr(masks[4u * texel_index + (slot >> 5u)], 1u << (slot & 31u));
    }
}
