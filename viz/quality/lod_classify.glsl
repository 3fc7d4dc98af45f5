#include "viz/quality/lod_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LodTileParams p; };
layout(constant_id = 0) const uint kSlopes = 1;
layout(set = 0, binding = 0) uniform usampler2D coarse_guide;
layout(scalar, set = 0, binding = 1) writeonly buffer Tiles { uint edge_of_tile[]; };
#ifdef KINO_LOD_OBJECT
layout(set = 0, binding = 2) uniform usampler2D coarse_object;
#endif

vec3 decoded(uint g) { return vec3(g & 255u, (g >> 8) & 255u, g >> 16); }

// A tile is flat if every two coarse neighbours that its pixels read are close: then Eq. 1 weighs
// little more than the tent does.
void main() {
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= p.tiles.x * p.tiles.y) return;
    uvec2 from = uvec2(tile % p.tiles.x, tile / p.tiles.x) * KINO_LOD_TILE_PX;
    uvec2 to = min(from + KINO_LOD_TILE_PX, p.fine) - 1u;
    ivec2 a = ivec2(floor(vec2(from) * p.coarse_of_fine.xy + p.coarse_of_fine.zw));
    ivec2 b = ivec2(floor(vec2(to) * p.coarse_of_fine.xy + p.coarse_of_fine.zw)) + 1;
    a = clamp(a, ivec2(0), p.last);
    b = clamp(b, ivec2(0), p.last);
    bool edge = false;
    for (int y = a.y; y <= b.y; ++y) {
        vec3 before = decoded(texelFetch(coarse_guide, ivec2(a.x, y), 0).r);
        for (int x = a.x; x <= b.x; ++x) {
            vec3 own = decoded(texelFetch(coarse_guide, ivec2(x, y), 0).r);
            vec3 above = decoded(texelFetch(coarse_guide, ivec2(x, max(y - 1, a.y)), 0).r);
            // On a plane the logarithm of depth rises by what the normal says.
            vec2 slope = (own.xy - 128.0) / kGuideNormalSteps;
            vec2 rise = vec2(0.0);
            if (kSlopes != 0u) {
                vec2 ray = (vec2(x, y) - p.coarse_k.zw) * p.coarse_k.xy;
                rise = slope * p.coarse_k.xy / max(1.0 - dot(slope, ray), 0.05) *
                       (kGuideStepsPerOctave * 1.44269504);
                rise = own.z > 0.0 ? rise : vec2(0.0);
            }
            vec3 left = abs(own - before) ;
            vec3 up = abs(own - above);
            float left_z = abs(own.z - before.z - (x > a.x ? rise.x : 0.0));
            float up_z = abs(own.z - above.z - (y > a.y ? rise.y : 0.0));
            float normals = max(max(left.x, left.y), max(up.x, up.y));
            edge = edge || normals > p.normal_steps || max(left_z, up_z) > p.depth_steps;
            // Half of it nothing: an edge, however near.
            edge = edge || (own.z > 0.0) != (before.z > 0.0) || (own.z > 0.0) != (above.z > 0.0);
#ifdef KINO_LOD_OBJECT
            uint id = texelFetch(coarse_object, ivec2(x, y), 0).r;
            edge = edge || id != texelFetch(coarse_object, ivec2(max(x - 1, a.x), y), 0).r ||
                   id != texelFetch(coarse_object, ivec2(x, max(y - 1, a.y)), 0).r;
#endif
            before = own;
        }
    }
    edge_of_tile[tile] = edge ? 1u : 0u;
}
