#version 460
#include "viz/light/shadow_head.glsl"
// Each pixel takes the mask of its texel, for both are in one tile, and slots mean the same lights.
// Where the texel was traced on another surface, a neighbour in the tile whose pixel lies in this
// one's plane is asked instead: else silhouettes get rims of light.
layout(set = 0, binding = 5) uniform usamplerBuffer traced;  // word_quads
layout(scalar, set = 0, binding = 6) writeonly buffer Masks { uvec4 masks[]; };

uvec2 tile_of(uvec2 texel) { return uvec2((vec2(2u * texel) + 0.5) * p.tile_scale); }

// Distance from the pixel's plane by its depth, and how far the normals turn; large: no such texel.
float mismatch(Place place, ivec2 texel, uvec2 own) {
    uvec2 inside = uvec2(clamp(texel, ivec2(0), ivec2(p.texels) - 1));
    bool same_tile = ivec2(inside) == texel && tile_of(inside) == tile_of(own);
    Place other = place_of(pixel_of(inside));
    float off = abs(dot(place.normal, other.at - place.at)) / max(place.at.z, 1e-6);
    float turned = 1.0 - dot(place.normal, other.normal);
    return same_tile && other.there ? off + 0.1 * turned : 1e9;
}

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    bool inside = at.x < p.size.x;
    at.x = min(at.x, p.size.x - 1u);
    Place place = place_of(ivec2(at));
    uvec2 own = at / 2u;
    uvec2 chosen = own;
    float best = mismatch(place, ivec2(own), own);
    // Towards the side of the texel that the pixel is on. No trips where the own one fits.
    ivec2 side = ivec2(at & 1u) * 2 - 1;
    uint tries = place.there && best > 0.01 ? 4u : 1u;
    for (uint i = 1u; i < tries; ++i) {
        ivec2 other = ivec2(own) + side * ivec2(i & 1u, i >> 1u);
        float found = mismatch(place, other, own);
        chosen = found < best ? uvec2(other) : chosen;
        best = min(found, best);
    }
    uvec4 mask = texelFetch(traced, int(chosen.y * p.texels.x + chosen.x));
    if (inside) masks[at.y * p.size.x + at.x] = mask;
}
