#version 460
#include "viz/accel/accel_head.glsl"
// One level of nodes, each with its range of triangles: becomes a leaf, or is cut at the highest
// bit in which its first and last code differ.
layout(local_size_x = 64) in;
layout(scalar, set = 0, binding = 0) readonly buffer Codes { uvec2 codes[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Frame { MortonFrame frame; };
layout(scalar, set = 0, binding = 2) buffer Nodes { BvhNode nodes[]; };

void main() {
    uint i = invocation();
    uint n = (1u << p.level) + i;
    if (i >= 1u << p.level) return;
    uint first = nodes[n].first;
    uint count = nodes[n].word >> 3u;
    uint end = first + count;
    uint low_code = count > 0u ? codes[first].x : 0u;
    uint differing = count > 0u ? low_code ^ codes[end - 1u].x : 0u;
    bool leaf = differing == 0u || count <= p.leaf_triangles || p.level == p.last_level;
    uint bit = uint(max(findMSB(differing), 0));
    // First code with the bit set, in [low, high).
    uint low = first;
    uint high = leaf ? first : end;
    while (low < high) {
        uint middle = (low + high) / 2u;
        bool set = ((codes[middle].x >> bit) & 1u) != 0u;
        high = set ? middle : high;
        low = set ? low : middle + 1u;
    }
    uint axis = ((bit < 15u ? frame.axes_lo : frame.axes_hi) >> (2u * (bit % 15u))) & 3u;
    if (count > 0u) nodes[n].word = (count << 3u) | (leaf ? kLeafBit : axis);
    if (p.level == p.last_level) return;
    uint left = leaf ? 0u : low - first;
    uint right = leaf ? 0u : end - low;
    nodes[2u * n] = BvhNode(vec3(0.0), leaf ? 0u : first, vec3(0.0), left << 3u);
    nodes[2u * n + 1u] = BvhNode(vec3(0.0), leaf ? 0u : low, vec3(0.0), right << 3u);
}
