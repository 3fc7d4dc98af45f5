#include "viz/surface/compute_head.glsl"
#include "viz/surface/visibility.glsl"
#include "viz/surface/payload.glsl"
#include "viz/surface/depth_inputs.glsl"

layout(constant_id = 1) const uint kHasColor = 1u;
layout(constant_id = 2) const uint kSinglePixel = 1u;

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= p.grid.x) return;
    uint i = at.y * p.grid.x + at.x;
    float z = depth_at(i);
    vec3 v = to_view(p, depth_point(z, KINO_RAY(at, i)));
    if (!(z > 0.0) || !(v.z >= p.near_m)) return;
    uint payload = kColorPayload == 0u ? i : kHasColor != 0u ? opaque(color_at(i)) : kUncolouredBits;
    vec2 centre = p.k.xy * v.xy / v.z + p.k.zw + 0.5;  // framebuffer coordinates
    // Also refuses what would not fit an int.
    vec2 margin = vec2(float(p.splat_cap_px));
    if (any(lessThan(centre, -margin)) || any(greaterThanEqual(centre, vec2(p.target) + margin))) return;
    if (kSinglePixel != 0u) {
        ivec2 pixel = ivec2(floor(centre));
        if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(p.target)))) return;
        put(uint(pixel.y) * p.target.x + uint(pixel.x), v.z, payload, p.key_pass);
    } else {
        // A depth pixel is z / focal wide in space; seen from here it covers this many pixels.
        float footprint = p.k.x * z / (p.depth_focal_px * v.z);
        float size = clamp(ceil(footprint), 1.0, float(p.splat_cap_px));
        ivec2 corner = ivec2(floor(centre - 0.5 * size + 0.5));
        ivec2 first = max(corner, ivec2(0));
        ivec2 last = min(corner + int(size), ivec2(p.target));
        for (int y = first.y; y < last.y; ++y) {
            for (int x = first.x; x < last.x; ++x) {
                put(uint(y) * p.target.x + uint(x), v.z, payload, p.key_pass);
            }
        }
    }
}
