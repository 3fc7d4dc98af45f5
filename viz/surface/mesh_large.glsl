#include "viz/surface/compute_head.glsl"
#include "viz/surface/visibility.glsl"
#include "viz/surface/payload.glsl"
#include "viz/surface/depth_inputs.glsl"
layout(scalar, set = 0, binding = 4) readonly buffer Large { LargeList large; uint large_triangles[]; };

layout(constant_id = 1) const uint kHasColor = 1u;

uint corner_color(uint i) {
    return kColorPayload != 0u && kHasColor != 0u ? color_at(i) : 0u;
}

vec2 to_pixel(vec3 v) { return p.k.xy * v.xy / v.z + p.k.zw + 0.5; }

// Grows the rectangle by the part of edge a-b that lies beyond the near plane.
void bound_edge(vec3 a, vec3 b, inout vec2 low, inout vec2 high) {
    if (a.z < p.near_m && b.z < p.near_m) return;
    if (a.z < p.near_m) a = mix(b, a, (b.z - p.near_m) / (b.z - a.z));
    if (b.z < p.near_m) b = mix(a, b, (a.z - p.near_m) / (a.z - b.z));
    a.z = max(a.z, p.near_m);
    b.z = max(b.z, p.near_m);
    vec2 pa = to_pixel(a);
    vec2 pb = to_pixel(b);
    low = min(low, min(pa, pb));
    high = max(high, max(pa, pb));
}

// Few lanes a triangle: each sets it up anew, and most triangles have some dozen pixels.
const uint kLanes = uint(KINO_LOCAL_SIZE) / KINO_TRIANGLES_A_GROUP;

// Several triangles a work group, since starting one costs, too. The pixel's ray is met with the
// triangle's plane in view space, so a corner behind the eye does no harm; the clipped outline only
// bounds the search.
void main() {
    uint group = gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x;
    uint slot = group * KINO_TRIANGLES_A_GROUP + gl_LocalInvocationID.x / kLanes;
    if (slot >= min(large.count, uint(large_triangles.length()))) return;
    uint lane = gl_LocalInvocationID.x % kLanes;
    uint id = large_triangles[slot];
    uvec3 corners = triangle_corners(p, id);
    vec3 a = to_view(p, depth_point(depth_at(corners.x), ray_at(corners.x)));
    vec3 b = to_view(p, depth_point(depth_at(corners.y), ray_at(corners.y)));
    vec3 c = to_view(p, depth_point(depth_at(corners.z), ray_at(corners.z)));
    vec2 low = vec2(1e9);
    vec2 high = vec2(-1e9);
    bound_edge(a, b, low, high);
    bound_edge(b, c, low, high);
    bound_edge(c, a, low, high);
    low = clamp(low, vec2(0.0), vec2(p.target));
    high = clamp(high, vec2(0.0), vec2(p.target));
    uvec2 first = uvec2(max(ceil(low - 0.5), 0.0));
    uvec2 last = uvec2(max(floor(high + 0.5), 0.0));  // one past the end
    if (last.x <= first.x || last.y <= first.y) return;
    uint wide = last.x - first.x;
    vec3 ab = b - a;
    vec3 ac = c - a;
    vec3 n = cross(ab, ac);
    float area2 = dot(n, n);
    if (!(area2 > 1e-20)) return;
    vec3 across_b = cross(ac, n) / area2;  // its dot product with (q - a) is the weight of b
    vec3 across_c = cross(n, ab) / area2;
    float distance = dot(a, n);
    uint color_b = color_or(corner_color(corners.y), corner_color(corners.z), corner_color(corners.x));
    uint color_c = color_or(corner_color(corners.z), color_b, color_b);
    uint color_a = color_or(corner_color(corners.x), color_b, color_b);
    const float kSlack = -1e-5;
    // The lanes walk the rows together. No division in the loop: lanes divide one after the other.
    uint step_y = kLanes / wide;
    uint step_x = kLanes - step_y * wide;
    uint lane_y = lane / wide;
    uvec2 pixel = first + uvec2(lane - lane_y * wide, lane_y);
    while (pixel.y < last.y) {
        vec3 ray = vec3((vec2(pixel) - p.k.zw) / p.k.xy, 1.0);
        float z = distance / dot(ray, n);
        vec3 q = ray * z - a;
        float wb = dot(q, across_b);
        float wc = dot(q, across_c);
        if (z >= p.near_m && wb >= kSlack && wc >= kSlack && wb + wc <= 1.0 - kSlack) {
            uint payload = id;
            if (kColorPayload != 0u) {
                payload = mix_colors(color_a, color_b, color_c, vec2(wb, wc));
            }
            put(pixel.y * p.target.x + pixel.x, z, payload, p.key_pass);
        }
        pixel += uvec2(step_x, step_y);
        if (pixel.x >= last.x) pixel = uvec2(pixel.x - wide, pixel.y + 1u);
    }
}
