#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/accel/accel_shared.h"
// One ray a lane, closest or any hit: what tests and benches hold against the processor's own.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kAny = 0u;
layout(push_constant, scalar) uniform Push { BuildParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer bvh_nodes;
layout(set = 0, binding = 1) uniform usamplerBuffer bvh_triangles;
layout(set = 0, binding = 2) uniform usamplerBuffer rays;
layout(scalar, set = 0, binding = 3) writeonly buffer Hits { TraceHit hits[]; };
#include "viz/accel/bvh.glsl"

void main() {
    uint i = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (i >= p.triangles) return;
    vec4 from = uintBitsToFloat(texelFetch(rays, int(2u * i)));
    vec4 to = uintBitsToFloat(texelFetch(rays, int(2u * i + 1u)));
    RayTest r = prepare_ray(from.xyz, from.w, to.xyz, to.w);
    if (kAny != 0u) {
        bool found = bvh_any(r, to.w);
        hits[i] = TraceHit(0.0, found ? 0u : kNoTriangle, 0.0, 0.0);
    } else {
        FoundHit hit = bvh_closest(r, to.w, 1u);
        hits[i] = TraceHit(hit.t, hit.triangle, hit.weights.x, hit.weights.y);
    }
}
