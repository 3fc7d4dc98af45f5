#include "viz/surface/compute_head.glsl"
#include "viz/surface/visibility.glsl"
layout(scalar, set = 0, binding = 1) readonly buffer Vertices { vec4 vertices[]; };
layout(scalar, set = 0, binding = 2) buffer Large { LargeList large; uint large_triangles[]; };

// Each listed triangle gets a work group in the pass that follows.
void list(uint triangle) {
    uint slot = atomicAdd(large.count, 1u);
    if (slot < uint(large_triangles.length())) {
        large_triangles[slot] = triangle;
        atomicMax(large.groups_x, min(slot + 1u, 65535u));
        atomicMax(large.groups_y, slot / 65535u + 1u);
    }
}

// One triangle of at most KINO_MICRO_LIMIT_PX a side, pixel by pixel. A pixel centre exactly on an
// edge belongs to both neighbours: the visibility buffer settles it, and nothing leaks between.
void raster(uint triangle, vec4 a, vec4 b, vec4 c) {
    vec2 low = min(a.xy, min(b.xy, c.xy));
    vec2 high = max(a.xy, max(b.xy, c.xy));
    if (any(greaterThan(low, vec2(p.target))) || any(lessThan(high, vec2(0.0)))) return;
    if (any(greaterThan(high - low, vec2(KINO_MICRO_LIMIT_PX)))) {
        list(triangle);
        return;
    }
    // Pixel centres at +0.5; coordinates relative to a keep float exact enough.
    ivec2 first = max(ivec2(ceil(low - 0.5)), ivec2(0));
    ivec2 last = min(ivec2(floor(high - 0.5)), ivec2(p.target) - 1);
    vec2 ab = b.xy - a.xy;
    vec2 ac = c.xy - a.xy;
    float area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0.0) return;
    float scale = 1.0 / area;
    // 1/z and both barycentrics are linear on the screen.
    vec3 inverse_z = vec3(a.z, b.z - a.z, c.z - a.z);
    const float kSlack = -1e-5;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            vec2 d = vec2(x, y) + 0.5 - a.xy;
            float wb = (d.x * ac.y - d.y * ac.x) * scale;
            float wc = (ab.x * d.y - ab.y * d.x) * scale;
            if (wb >= kSlack && wc >= kSlack && wb + wc <= 1.0 - kSlack) {
                float z = 1.0 / (inverse_z.x + wb * inverse_z.y + wc * inverse_z.z);
                put(uint(y) * p.target.x + uint(x), z, triangle, p.key_pass);
            }
        }
    }
}

void triangle(uint id, vec4 a, vec4 b, vec4 c) {
    if (!keep_triangle(p, a.w, b.w, c.w)) return;
    float nearest = max(a.z, max(b.z, c.z));
    if (nearest <= 0.0) return;  // all of it in front of the near plane
    if (min(a.z, min(b.z, c.z)) <= 0.0) {
        list(id);
    } else {
        raster(id, a, b, c);
    }
}

void main() {
    uint cell = gl_GlobalInvocationID.x;
    uint cells_x = p.grid.x - 1u;
    if (cell >= cells_x * (p.grid.y - 1u)) return;
    uint base = (cell / cells_x) * p.grid.x + cell % cells_x;
    vec4 v00 = vertices[base];
    vec4 v10 = vertices[base + 1u];
    vec4 v01 = vertices[base + p.grid.x];
    vec4 v11 = vertices[base + p.grid.x + 1u];
    triangle(2u * cell, v00, v10, v01);
    triangle(2u * cell + 1u, v10, v11, v01);
}
