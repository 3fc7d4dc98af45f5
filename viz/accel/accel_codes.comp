#version 460
#include "viz/accel/accel_head.glsl"
// Morton code of each triangle, with its place in the soup.
layout(local_size_x = 64) in;
layout(scalar, set = 0, binding = 0) readonly buffer Soup { SoupTriangle soup[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Frame { MortonFrame frame; };
layout(scalar, set = 0, binding = 2) writeonly buffer Codes { uvec2 codes[]; };

void main() {
    uint i = invocation();
    if (i >= p.triangles) return;
    precise vec3 cell = (centroid_of(soup[i]) - frame.lo) * frame.scale;
    uvec3 left = uvec3(max(vec3(0.0), min(cell, frame.cells - 1.0)));
    uint code = 0u;
    for (uint bit = 0u; bit < 30u; ++bit) {
        uint axis = ((bit < 15u ? frame.axes_lo : frame.axes_hi) >> (2u * (bit % 15u))) & 3u;
        uvec3 chosen = uvec3(equal(uvec3(axis), uvec3(0u, 1u, 2u)));
        uvec3 lowest = left & chosen;
        code |= (lowest.x | lowest.y | lowest.z) << bit;
        left >>= chosen;
    }
    codes[i] = uvec2(code, i);
}
