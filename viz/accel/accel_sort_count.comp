#version 460
#include "viz/accel/accel_head.glsl"
// How often each digit comes up in each lane's run of the keys. A lane has counters of its own, so
// that order is kept and nothing is atomic.
layout(local_size_x = 8) in;
layout(scalar, set = 0, binding = 0) readonly buffer Codes { uvec2 codes[]; };
layout(scalar, set = 0, binding = 1) buffer Counts { uint counts[]; };

void main() {
    uint lane = gl_GlobalInvocationID.x;
    uint run = (p.triangles + p.lanes - 1u) / p.lanes;
    for (uint digit = 0u; digit < 256u; ++digit) counts[digit * p.lanes + lane] = 0u;
    uint end = min((lane + 1u) * run, p.triangles);
    for (uint i = lane * run; i < end; ++i) {
        counts[((codes[i].x >> p.shift) & 255u) * p.lanes + lane] += 1u;
    }
}
