#version 460
#include "viz/accel/accel_head.glsl"
// The axis of each bit, once a build; morton_frame() in C++ is the same. Also makes the root.
layout(local_size_x = 1) in;
layout(constant_id = 0) const uint kLongestCell = 1u;
layout(scalar, set = 0, binding = 0) readonly buffer Keys { uint keys[6]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Frame { MortonFrame frame; };
layout(scalar, set = 0, binding = 2) writeonly buffer Nodes { BvhNode nodes[]; };

void main() {
    vec3 lo = vec3(value_of(keys[0]), value_of(keys[1]), value_of(keys[2]));
    vec3 hi = vec3(value_of(~keys[3]), value_of(~keys[4]), value_of(~keys[5]));
    precise vec3 extent = hi - lo;
    vec3 edge = extent;
    uint bits[3] = uint[3](0u, 0u, 0u);
    uint axes[2] = uint[2](0u, 0u);
    for (int bit = 29; bit >= 0; --bit) {
        uint axis = uint(29 - bit) % 3u;
        if (kLongestCell != 0u) {
            float longest = -1.0;
            for (uint k = 0u; k < 3u; ++k) {
                bool longer = edge[k] > longest && bits[k] < 20u;
                axis = longer ? k : axis;
                longest = longer ? edge[k] : longest;
            }
            edge[axis] *= 0.5;
        }
        ++bits[axis];
        axes[bit / 15] |= axis << uint(2 * (bit % 15));
    }
    vec3 cells = vec3(1u << bits[0], 1u << bits[1], 1u << bits[2]);
    precise vec3 scale;
    for (uint k = 0u; k < 3u; ++k) {
        precise float inverse = 1.0 / extent[k];
        scale[k] = extent[k] > 0.0 ? cells[k] * inverse : 0.0;
        if (!(scale[k] < 3e38)) scale[k] = 0.0;
    }
    frame = MortonFrame(lo, 0u, cells, axes[0], scale, axes[1]);
    nodes[0] = BvhNode(vec3(0.0), 0u, vec3(0.0), 0u);
    nodes[1] = BvhNode(vec3(0.0), 0u, vec3(0.0), p.triangles << 3u);
}
