#version 460
#include "viz/accel/accel_head.glsl"
// Counts become the places where each lane's keys of each digit begin.
layout(local_size_x = 64) in;
layout(scalar, set = 0, binding = 0) buffer Counts { uint counts[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Totals { uint totals[256]; };

void main() {
    uint digit = gl_GlobalInvocationID.x;
    uint first = 0u;
    for (uint below = 0u; below < digit; ++below) first += totals[below];
    for (uint lane = 0u; lane < p.lanes; ++lane) {
        uint count = counts[digit * p.lanes + lane];
        counts[digit * p.lanes + lane] = first;
        first += count;
    }
}
