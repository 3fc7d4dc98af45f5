#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer tile_bounds;
layout(set = 0, binding = 1) uniform usamplerBuffer volumes;
layout(scalar, set = 0, binding = 2) writeonly buffer Words { uint macro_words[]; };
#include "viz/light/tile_volume.glsl"
layout(constant_id = 5) const uint kChunkWords = 8u;

// One lane a macro tile and chunk of lights: which of them reach it, a bit each. All lanes look at
// the same light at the same time, and none of them branches.
void main() {
    uint macro = gl_GlobalInvocationID.x;
    if (macro >= p.macros) return;
    uvec2 at = uvec2(macro % p.macros_x, macro / p.macros_x);
    TileBounds all;
    all.min_z = 1e30;
    all.max_z = 0.0;
    all.cells = 0u;
    for (uint i = 0u; i < kMacroTiles * kMacroTiles; ++i) {
        uvec2 tile = min(at * kMacroTiles + uvec2(i % kMacroTiles, i / kMacroTiles), p.tiles - 1u);
        TileBounds b = bounds_from(texelFetch(tile_bounds, int(tile.y * p.tiles.x + tile.x)));
        all.min_z = min(all.min_z, b.min_z);
        all.max_z = max(all.max_z, b.max_z);
    }
    TileVolume volume =
        volume_of_pixels(at * kMacroTiles * kTilePx, (at + 1u) * kMacroTiles * kTilePx, all);
    uint first = gl_GlobalInvocationID.y * kChunkWords;
    uint end = min(first + kChunkWords, p.words);
    for (uint w = first; w < end; ++w) {
        uint bits = 0u;
        for (uint b = 0u; b < 32u; ++b) {
            uint light = w * 32u + b;
            vec4 sphere = uintBitsToFloat(texelFetch(volumes, int(min(light, p.locals - 1u))));
            vec2 depths;
            vec3 low, high;
            bool touches = sphere_touches(volume, sphere, depths, low, high) && light < p.locals;
            bits |= touches ? 1u << b : 0u;
        }
        macro_words[macro * p.words + w] = bits;
    }
}
