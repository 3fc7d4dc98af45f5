#version 460
#include "viz/accel/accel_head.glsl"
// One invocation a digit: how often it comes up in all.
layout(local_size_x = 64) in;
layout(scalar, set = 0, binding = 0) readonly buffer Counts { uint counts[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Totals { uint totals[256]; };

void main() {
    uint digit = gl_GlobalInvocationID.x;
    uint sum = 0u;
    for (uint lane = 0u; lane < p.lanes; ++lane) sum += counts[digit * p.lanes + lane];
    totals[digit] = sum;
}
