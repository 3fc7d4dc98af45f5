#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform sampler2D view_z;
layout(scalar, set = 0, binding = 1) writeonly buffer Bounds { TileBounds bounds[]; };
layout(constant_id = 0) const uint kTilePx = 16u;
layout(constant_id = 3) const uint kBlended = 0u;
#include "viz/light/depth_cells.glsl"

const float kNowhere = 1e30;

// One lane a tile. The trips are the same for all lanes; those that would leave the picture look
// at its last pixel again.
void main() {
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= p.tiles.x * p.tiles.y) return;
    ivec2 from = ivec2(tile % p.tiles.x, tile / p.tiles.x) * int(kTilePx);
    ivec2 last = ivec2(p.size) - 1;
    float least = kNowhere;
    float most = 0.0;
    float nothing = 0.0;
    for (int y = 0; y < int(kTilePx); ++y) {
        for (int x = 0; x < int(kTilePx); ++x) {
            float z = texelFetch(view_z, min(from + ivec2(x, y), last), 0).r;
            least = min(least, z > 0.0 ? z : kNowhere);
            most = max(most, z);
            nothing = z > 0.0 ? nothing : 1.0;
        }
    }
    TileBounds b;
    b.min_z = least;
    b.max_z = most;
    b.cells = 0xFFFFFFFFu;
    b.reserved = 0u;
    if (kBlended != 0u) {
        // What is blended lies anywhere before the opaque surface, or before nothing at all.
        b.min_z = 0.0;
        b.max_z = nothing > 0.0 ? kNowhere : most;
    } else if (kCells != 0u) {
        float scale = cell_scale(least, most);
        uint cells = 0u;
        for (int y = 0; y < int(kTilePx); ++y) {
            for (int x = 0; x < int(kTilePx); ++x) {
                float z = texelFetch(view_z, min(from + ivec2(x, y), last), 0).r;
                cells |= z > 0.0 ? 1u << as_cell(cell_of(z, least, scale)) : 0u;
            }
        }
        b.cells = cells;
    }
    bounds[tile] = b;
}
