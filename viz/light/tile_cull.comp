#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer tile_bounds;
layout(set = 0, binding = 1) uniform usamplerBuffer volumes;
layout(set = 0, binding = 2) uniform usamplerBuffer lights;
layout(set = 0, binding = 3) uniform usamplerBuffer macro_words;
layout(scalar, set = 0, binding = 4) buffer Headers { uvec2 headers[]; };
layout(scalar, set = 0, binding = 5) writeonly buffer Indices { uint indices[]; };
layout(scalar, set = 0, binding = 6) buffer Counters { LightListCounters counters; };
#include "viz/light/tile_volume.glsl"
layout(constant_id = 5) const uint kTwoLevel = 1u;
// 0: every tile has room for its capacity. 1: count only. 2: fill the segments that the sums gave.
layout(constant_id = 6) const uint kStage = 0u;

bool light_touches(TileVolume volume, uint light) {
    vec4 sphere = uintBitsToFloat(texelFetch(volumes, int(light)));
    vec2 depths;
    vec3 low, high;
    bool touches = sphere_touches(volume, sphere, depths, low, high);
    if (kCells != 0u) touches = touches && cells_touch(volume, depths);
    if (kSpots != 0u) {
        int record = int((p.first_local + light) * 4u);
        uvec4 place = texelFetch(lights, record);
        vec4 cone = uintBitsToFloat(texelFetch(lights, record + 2));
        float reach = uintBitsToFloat(texelFetch(lights, record + 1).w);
        touches = touches && !(place.w == 2u && cone_misses(uintBitsToFloat(place.xyz), reach,
                                                            cone.xyz, cone.w, low, high));
    }
    return touches;
}

// One lane a tile. The tiles of a macro tile lie side by side, so lanes walk the same lights, and
// each writes its own list in ascending order: the same one every time.
void main() {
    // Threads of a CPU device take work groups by halves; this deals them out in turn.
    uint groups = gl_NumWorkGroups.x;
    uint half_groups = (groups + 1u) / 2u;
    uint group = gl_WorkGroupID.x;
    group = group < half_groups ? 2u * group : 2u * (group - half_groups) + 1u;
    uint lane = group * 64u + gl_LocalInvocationID.x;
    uint macro = lane / (kMacroTiles * kMacroTiles);
    uint within = lane % (kMacroTiles * kMacroTiles);
    uvec2 at = uvec2(macro % p.macros_x, macro / p.macros_x) * kMacroTiles +
               uvec2(within % kMacroTiles, within / kMacroTiles);
    if (macro >= p.macros || at.x >= p.tiles.x || at.y >= p.tiles.y) return;
    uint tile = at.y * p.tiles.x + at.x;
    TileBounds bounds = bounds_from(texelFetch(tile_bounds, int(tile)));
    TileVolume volume = volume_of_pixels(at * kTilePx, (at + 1u) * kTilePx, bounds);
    uint first = tile * p.capacity;
    uint room = p.capacity;
    if (kStage == 2u) {
        first = headers[tile].x;
        room = headers[tile].y;
    }
    uint found = 0u;
    for (uint w = 0u; w < p.words; ++w) {
        uint bits = kTwoLevel != 0u ? texelFetch(macro_words, int(macro * p.words + w)).x
                                    : 0xFFFFFFFFu >> (32u - min(p.locals - w * 32u, 32u));
        // Tested first and stored afterwards: a store costs each lane a branch, taken or not, and
        // most candidates are not stored.
        uint hits = 0u;
        while (bits != 0u) {
            uint bit = uint(findLSB(bits));
            bits &= bits - 1u;
            hits |= light_touches(volume, w * 32u + bit) ? 1u << bit : 0u;
        }
        if (kStage == 1u) {
            found += uint(bitCount(hits));
            hits = 0u;
        }
        while (hits != 0u) {
            if (found < room) indices[first + found] = p.first_local + w * 32u + uint(findLSB(hits));
            hits &= hits - 1u;
            ++found;
        }
    }
    if (kStage == 2u) return;
    headers[tile] = uvec2(first, min(found, room));
    if (found > room) {
        atomicAdd(counters.overflowing_tiles, 1u);
        atomicAdd(counters.dropped, found - room);
    }
}
