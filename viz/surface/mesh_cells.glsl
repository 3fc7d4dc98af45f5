#include "viz/surface/compute_head.glsl"
#include "viz/surface/visibility.glsl"
#include "viz/surface/payload.glsl"
#include "viz/surface/depth_inputs.glsl"
layout(scalar, set = 0, binding = 4) buffer Large { LargeList large; uint large_triangles[]; };

layout(constant_id = 1) const uint kHasColor = 1u;
// Cells a thread walks down: the lower corners of one are the upper corners of the next, so a
// cell costs two new vertices. Projecting each of them twice (its right neighbour does, too) is
// cheaper than a pass that stores them: loads and stores are what a lane pays most for.
const uint kStrip = 16u;

// A depth pixel as a vertex: framebuffer x and y, 1 / view depth (negative: nearer than the near
// plane, the other pass clips it), and its own depth (0: no reading).
vec4 vertex(uvec2 at) {
    uint i = at.y * p.grid.x + at.x;
    float z = depth_at(i);
    vec3 v = to_view(p, depth_point(z, KINO_RAY(at, i)));
    float inverse_z = v.z >= p.near_m ? 1.0 / v.z : -1.0;
    return vec4(p.k.xy * v.xy * inverse_z + p.k.zw + 0.5, inverse_z, z);
}

// The pass that follows takes KINO_TRIANGLES_A_GROUP of them in a work group.
void list(uint triangle) {
    uint slot = atomicAdd(large.count, 1u);
    if (slot < uint(large_triangles.length())) {
        large_triangles[slot] = triangle;
        uint group = slot / KINO_TRIANGLES_A_GROUP;
        atomicMax(large.groups_x, min(group + 1u, 65535u));
        atomicMax(large.groups_y, group / 65535u + 1u);
    }
}

uint corner_color(uint i) {
    return kColorPayload != 0u && kHasColor != 0u ? color_at(i) : 0u;
}

// False where nothing of the cell can be on the screen: off to a side, or wholly nearer than the
// near plane. A cell that crosses the near plane has no bounds yet and passes.
bool on_screen(vec3 a, vec3 b, vec3 c, vec3 d) {
    vec2 low = min(min(a.xy, b.xy), min(c.xy, d.xy));
    vec2 high = max(max(a.xy, b.xy), max(c.xy, d.xy));
    bool inside = all(lessThan(low, vec2(p.target))) && all(greaterThan(high, vec2(0.0)));
    float nearest = max(max(a.z, b.z), max(c.z, d.z));
    float farthest = min(min(a.z, b.z), min(c.z, d.z));
    return nearest > 0.0 && (inside || farthest <= 0.0);
}

// A cell's two triangles, (00, 10, 01) and (10, 11, 01), in one walk over the pixels of their
// common bounds. A pixel centre exactly on an edge belongs to both neighbours: the visibility
// buffer settles it, and nothing leaks between.
void raster(uint cell, uint kept, vec3 a, vec3 b, vec3 c, vec3 d, uvec4 colors) {
    vec2 low = min(min(a.xy, b.xy), min(c.xy, d.xy));
    vec2 high = max(max(a.xy, b.xy), max(c.xy, d.xy));
    float farthest = min(min(a.z, b.z), min(c.z, d.z));
    // Corners nearer than the near plane have no place on the screen: clipped in the other pass.
    bool crossing = farthest <= 0.0;
    // Pixel centres at +0.5. Clamped before the conversion: far outside would not fit an int.
    ivec2 first = ivec2(ceil(clamp(low, vec2(0.0), vec2(p.target)) - 0.5));
    ivec2 last = min(ivec2(floor(clamp(high, vec2(0.0), vec2(p.target)) - 0.5)), ivec2(p.target) - 1);
    ivec2 size = max(last - first + 1, ivec2(0));
    bool micro = !crossing && size.x * size.y <= KINO_MICRO_LIMIT_PIXELS;
    bool listed = crossing || !micro;
    for (uint k = 0u; k < (listed ? 2u : 0u); ++k) {
        if ((kept & (1u << k)) != 0u) list(2u * cell + k);
    }
    int count = micro ? size.x * size.y : 0;
    // Coordinates relative to a corner keep float exact enough.
    vec2 ab = b.xy - a.xy;
    vec2 ac = c.xy - a.xy;
    vec2 dc = c.xy - d.xy;
    vec2 db = b.xy - d.xy;
    float area0 = ab.x * ac.y - ab.y * ac.x;
    float area1 = dc.x * db.y - dc.y * db.x;
    float scale0 = (kept & 1u) != 0u && area0 != 0.0 ? 1.0 / area0 : 0.0;
    float scale1 = (kept & 2u) != 0u && area1 != 0.0 ? 1.0 / area1 : 0.0;
    // Of b and c, then of the first and the second triangle's own corner.
    uint color_b = color_or(colors.y, colors.z, colors.x);
    uint color_c = color_or(colors.z, colors.y, colors.w);
    uint color_a = color_or(colors.x, color_b, color_b);
    uint color_d = color_or(colors.w, color_c, color_c);
    const float kSlack = 1e-5;
    ivec2 at = first;
    for (int k = 0; k < count; ++k) {
        vec2 from_a = vec2(at) + 0.5 - a.xy;
        vec2 from_d = vec2(at) + 0.5 - d.xy;
        // Weights of b and c in either triangle; the third corner has the rest.
        vec2 w0 = vec2(from_a.x * ac.y - from_a.y * ac.x, ab.x * from_a.y - ab.y * from_a.x) * scale0;
        vec2 w1 = vec2(dc.x * from_d.y - dc.y * from_d.x, from_d.x * db.y - from_d.y * db.x) * scale1;
        bool in0 = scale0 != 0.0 && min(w0.x, w0.y) >= -kSlack && w0.x + w0.y <= 1.0 + kSlack;
        bool in1 = scale1 != 0.0 && min(w1.x, w1.y) >= -kSlack && w1.x + w1.y <= 1.0 + kSlack;
        // 1/z is linear on the screen.
        float i0 = a.z + w0.x * (b.z - a.z) + w0.y * (c.z - a.z);
        float i1 = d.z + w1.x * (b.z - d.z) + w1.y * (c.z - d.z);
        bool second = in1 && (!in0 || i1 > i0);
        if (in0 || in1) {
            float inverse_z = second ? i1 : i0;
            vec2 w = second ? w1 : w0;
            float z = 1.0 / inverse_z;
            uint payload = 2u * cell + (second ? 1u : 0u);
            if (kColorPayload != 0u) {
                // From the screen's weights to those in space.
                payload = mix_colors(second ? color_d : color_a, color_b, color_c,
                                     w * vec2(b.z, c.z) * z);
            }
            put(uint(at.y) * p.target.x + uint(at.x), z, payload, p.key_pass);
        }
        ++at.x;
        if (at.x > last.x) at = ivec2(first.x, at.y + 1);
    }
}

void main() {
    uint cells_x = p.grid.x - 1u;
    uint cells_y = p.grid.y - 1u;
    uint column = gl_GlobalInvocationID.x;
    uint first_row = gl_GlobalInvocationID.y * kStrip;
    uint end_row = min(first_row + kStrip, cells_y);
    if (column >= cells_x) return;
    uint i = first_row * p.grid.x + column;
    vec4 upper_left = vertex(uvec2(column, first_row));
    vec4 upper_right = vertex(uvec2(column + 1u, first_row));
    uvec2 upper_colors = uvec2(corner_color(i), corner_color(i + 1u));
    for (uint row = first_row; row < end_row; ++row) {
        vec4 lower_left = vertex(uvec2(column, row + 1u));
        vec4 lower_right = vertex(uvec2(column + 1u, row + 1u));
        i += p.grid.x;
        uvec2 lower_colors = uvec2(corner_color(i), corner_color(i + 1u));
        uint kept = (keep_triangle(p, upper_left.w, upper_right.w, lower_left.w) ? 1u : 0u) |
                    (keep_triangle(p, upper_right.w, lower_right.w, lower_left.w) ? 2u : 0u);
        // A loop, not an if: it really skips where no lane has anything to draw.
        bool wanted = kept != 0u && on_screen(upper_left.xyz, upper_right.xyz, lower_left.xyz,
                                              lower_right.xyz);
        for (uint once = 0u; once < (wanted ? 1u : 0u); ++once) {
            raster(row * cells_x + column, kept, upper_left.xyz, upper_right.xyz, lower_left.xyz,
                   lower_right.xyz, uvec4(upper_colors, lower_colors));
        }
        upper_left = lower_left;
        upper_right = lower_right;
        upper_colors = lower_colors;
    }
}
