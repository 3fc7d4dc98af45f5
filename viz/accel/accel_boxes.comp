#version 460
#include "viz/accel/accel_head.glsl"
// One level of boxes, from the last level up: a leaf's round its triangles, another's round its
// children's.
layout(local_size_x = 64) in;
layout(scalar, set = 0, binding = 0) readonly buffer Triangles { BvhTriangle triangles[]; };
layout(scalar, set = 0, binding = 1) buffer Nodes { BvhNode nodes[]; };

void main() {
    uint i = invocation();
    uint n = (1u << p.level) + i;
    if (i >= 1u << p.level) return;
    uint word = nodes[n].word;
    uint first = nodes[n].first;
    bool leaf = (word & kLeafBit) != 0u;
    vec3 lo = vec3(3.4e38);
    vec3 hi = vec3(-3.4e38);
    uint count = leaf ? word >> 3u : 0u;
    for (uint k = first; k < first + count; ++k) {
        vec3 a = triangles[k].a;
        vec3 b = triangles[k].b;
        vec3 c = triangles[k].c;
        lo = min(lo, min(a, min(b, c)));
        hi = max(hi, max(a, max(b, c)));
    }
    uint children = word != 0u && !leaf ? 2u : 0u;
    for (uint k = 2u * n; k < 2u * n + children; ++k) {
        lo = min(lo, nodes[k].lo);
        hi = max(hi, nodes[k].hi);
    }
    if (word == 0u) return;
    nodes[n].lo = lo;
    nodes[n].hi = hi;
}
