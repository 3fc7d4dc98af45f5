#version 460
#include "viz/accel/accel_head.glsl"
// Triangles in the tree's order: by the sorted codes when it is built, by the ids that it has when
// it is refitted.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kRefit = 0u;
layout(scalar, set = 0, binding = 0) readonly buffer Soup { SoupTriangle soup[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Codes { uvec2 codes[]; };
layout(scalar, set = 0, binding = 2) buffer Triangles { BvhTriangle triangles[]; };

void main() {
    uint i = invocation();
    if (i >= p.triangles) return;
    uint id = kRefit != 0u ? triangles[i].id : codes[i].y;
    SoupTriangle t = soup[id];
    triangles[i] = BvhTriangle(t.a, id, t.b, 0u, t.c, 0u);
}
