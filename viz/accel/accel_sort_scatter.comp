#version 460
#include "viz/accel/accel_head.glsl"
// Each lane takes its run in order to the places it counted out.
layout(local_size_x = 8) in;
layout(scalar, set = 0, binding = 0) readonly buffer Codes { uvec2 codes[]; };
layout(scalar, set = 0, binding = 1) buffer Counts { uint counts[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer Sorted { uvec2 sorted[]; };

void main() {
    uint lane = gl_GlobalInvocationID.x;
    uint run = (p.triangles + p.lanes - 1u) / p.lanes;
    uint end = min((lane + 1u) * run, p.triangles);
    for (uint i = lane * run; i < end; ++i) {
        uvec2 item = codes[i];
        uint counter = ((item.x >> p.shift) & 255u) * p.lanes + lane;
        uint place = counts[counter];
        counts[counter] = place + 1u;
        sorted[place] = item;
    }
}
