#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_shared.h"
#include "viz/quality/lod_regions_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LodRegionParams p; };
layout(constant_id = 0) const uint kStep = 0u;  // of the four below
layout(constant_id = 1) const uint kKeepBackground = 1u;
layout(constant_id = 2) const uint kMetric = 2u;
layout(constant_id = 3) const uint kDoubted = 1u;  // doubtful texels are counted
layout(constant_id = 4) const uint kBend = 0u;     // RegionMeasure
layout(constant_id = 5) const uint kFineGrained = 1u;
layout(set = 0, binding = 0) uniform sampler2D coarse_linear;
layout(set = 0, binding = 1) uniform sampler2D coarse_albedo;
layout(set = 0, binding = 2) uniform usampler2D coarse_guide;
layout(set = 0, binding = 3) uniform sampler2D view_z;
layout(set = 0, binding = 4) uniform sampler2D normal;
layout(set = 0, binding = 5) uniform usamplerBuffer parent_texels;  // 0: the tile stayed coarse
layout(scalar, set = 0, binding = 6) buffer Rows { uvec2 rows[]; };
layout(scalar, set = 0, binding = 7) buffer Tiles { uint texels[]; };
layout(scalar, set = 0, binding = 8) buffer Places { uint places[]; };
layout(scalar, set = 0, binding = 9) buffer State { LodRegionState state; };
layout(scalar, set = 0, binding = 10) writeonly buffer Listed { uint listed[]; };
#include "viz/quality/lod_eq1.glsl"

uvec2 tile_at(uint tile) {
    return uvec2(tile % p.tiles.x, tile / p.tiles.x);
}
uvec2 extent_of(uvec2 at) {
    return min(uvec2(p.side), p.fine - at * p.side);
}

// Light as it will be shown on this texel's colour, square root for the eye, and its colour.
vec2 shown_at(ivec2 at) {
    const vec3 kLuma = vec3(0.2126, 0.7152, 0.0722);
    vec3 linear = finite_light(texelFetch(coarse_linear, at, 0).rgb);
    vec4 seen = texelFetch(coarse_albedo, at, 0);
    float color = kFineGrained != 0u ? max(dot(from_srgb(seen.rgb), kLuma), 1e-3) : 1.0;
    float light = seen.a > 0.0 ? dot(linear, kLuma) * p.exposure / color : 0.0;
    return vec2(sqrt(light), sqrt(color));
}

// Whether two neighbours, the second to the right or below, lie on one surface.
bool one_surface(uint a, uint b, ivec2 at, bool right) {
    vec3 own = vec3(a & 255u, (a >> 8) & 255u, a >> 16);
    vec3 other = vec3(b & 255u, (b >> 8) & 255u, b >> 16);
    vec2 slope = (own.xy - 128.0) / kGuideNormalSteps;
    vec2 ray = ((vec2(at) - p.coarse_of_fine.zw) / p.coarse_of_fine.xy - p.fine_k.zw) * p.fine_k.xy;
    vec2 rise = slope * (p.fine_k.xy / p.coarse_of_fine.xy) / max(1.0 - dot(slope, ray), 0.05) *
                (kGuideStepsPerOctave * 1.44269504);
    vec3 off = abs(other - own - vec3(0.0, 0.0, right ? rise.x : rise.y));
    return own.z > 0.0 && other.z > 0.0 && max(off.x, off.y) <= p.normal_steps &&
           off.z <= p.depth_steps;
}

// Largest step of light between neighbours around one row of a tile.
float largest_step(uvec2 from, uint width) {
    vec2 first = vec2(from) * p.coarse_of_fine.xy + p.coarse_of_fine.zw;
    float last_x = float(from.x + width - 1u) * p.coarse_of_fine.x + p.coarse_of_fine.z;
    int y = clamp(int(floor(first.y)), 0, p.last.y);
    int x0 = clamp(int(floor(first.x)), 0, p.last.x);
    int x1 = clamp(int(floor(last_x)) + 1, 0, p.last.x);
    float most = 0.0;
    for (int x = x0; x <= x1; ++x) {
        ivec2 here = ivec2(x, y);
        vec2 own = shown_at(here);
        uint guide = texelFetch(coarse_guide, here, 0).r;
        for (int way = 0; way < 2; ++way) {
            ivec2 by = way == 0 ? ivec2(1, 0) : ivec2(0, 1);
            ivec2 after = min(here + by, p.last);
            uint after_guide = texelFetch(coarse_guide, after, 0).r;
            bool joined = after != here && one_surface(guide, after_guide, here, way == 0);
            vec2 beyond = shown_at(after);
            float change = abs(beyond.x - own.x) * min(beyond.y, own.y);
            if (kBend != 0u) {
                ivec2 before = max(here - by, ivec2(0));
                uint before_guide = texelFetch(coarse_guide, before, 0).r;
                joined =
                    joined && before != here && one_surface(before_guide, guide, before, way == 0);
                change = 0.5 * abs(shown_at(before).x + beyond.x - 2.0 * own.x) * own.y;
            }
            most = max(most, joined ? change : 0.0);
        }
    }
    return most;
}

// How many texels of a row no coarse one resembles.
uint doubtful(uvec2 from, uint width) {
    uint found = 0u;
    for (uint k = 0u; k < width; ++k) {
        ivec2 here = ivec2(from.x + k, from.y);
        float z = texelFetch(view_z, here, 0).r;
        FineGuide fine =
            packed_fine_guide(vec2(here), z, from_octahedral(texelFetch(normal, here, 0).rg));
        Footprint at = footprint_of(fine.place, p.coarse_of_fine, p.last);
        uvec4 guide = uvec4(texelFetch(coarse_guide, at.a, 0).r,
                            texelFetch(coarse_guide, ivec2(at.b.x, at.a.y), 0).r,
                            texelFetch(coarse_guide, ivec2(at.a.x, at.b.y), 0).r,
                            texelFetch(coarse_guide, at.b, 0).r);
        vec4 e = eq1_exponents(
            fine, unpacked_guides(guide, vec4(at.a.x, at.b.x, at.a.x, at.b.x),
                                  vec4(at.a.y, at.a.y, at.b.y, at.b.y), vec4(0.0), 0.0));
        float least = min(min(e.x, e.y), min(e.z, e.w));
        found += is_there(z) && least > p.doubt_limit ? 1u : 0u;
    }
    return found;
}

// 0, a lane each row of a tile.
void rate_rows() {
    uint i = gl_GlobalInvocationID.x;
    uint tile = i / p.side;
    if (tile >= p.tiles.x * p.tiles.y) return;
    uvec2 at = tile_at(tile);
    uvec2 extent = extent_of(at);
    uint row = i % p.side;
    if (row >= extent.y) return;
    uvec2 from = at * p.side + uvec2(0u, row);
    uint doubts = kDoubted != 0u ? doubtful(from, extent.x) : 0u;
    rows[i] = uvec2(doubts, floatBitsToUint(largest_step(from, extent.x)));
}

// 1, a lane a tile: whether it is shaded finer.
void choose() {
    uint tile = gl_GlobalInvocationID.x;
    if (tile >= p.tiles.x * p.tiles.y) return;
    uvec2 at = tile_at(tile);
    uvec2 extent = extent_of(at);
    uint doubts = 0u;
    float most = 0.0;
    for (uint row = 0u; row < extent.y; ++row) {
        doubts += rows[tile * p.side + row].x;
        most = max(most, uintBitsToFloat(rows[tile * p.side + row].y));
    }
    uint area = extent.x * extent.y;
    bool finer = most >= p.limit || (kDoubted != 0u && float(doubts) > p.doubt_share * float(area));
    if (p.parents.x != 0u) {
        vec2 middle = (vec2(at * p.side) + 0.5 * vec2(extent)) * p.coarse_of_fine.xy;
        uvec2 parent = min(uvec2(middle) / p.parent_side, p.parents - 1u);
        finer = finer && texelFetch(parent_texels, int(parent.y * p.parents.x + parent.x)).r != 0u;
    }
    texels[tile] = finer ? area : 0u;
}

// 2, one lane: where each tile's texels are in the list.
void sum_tiles() {
    if (gl_GlobalInvocationID.x != 0u) return;
    uint sum = 0u;
    uint finer = 0u;
    for (uint tile = 0u; tile < p.tiles.x * p.tiles.y; ++tile) {
        places[tile] = sum;
        sum += texels[tile];
        finer += texels[tile] != 0u ? 1u : 0u;
    }
    state.groups_x = (sum + 63u) / 64u;
    state.groups_y = 1u;
    state.groups_z = 1u;
    state.count = sum;
    state.tiles = finer;
}

// 3, a lane each row of a tile.
void write_rows() {
    uint i = gl_GlobalInvocationID.x;
    uint tile = i / p.side;
    if (tile >= p.tiles.x * p.tiles.y) return;
    uvec2 at = tile_at(tile);
    uvec2 extent = extent_of(at);
    uint row = i % p.side;
    uint width = row < extent.y && texels[tile] != 0u ? extent.x : 0u;
    uint place = places[tile] + row * extent.x;
    uvec2 from = at * p.side + uvec2(0u, row);
    for (uint k = 0u; k < width; ++k) listed[place + k] = from.y << 16 | (from.x + k);
}

void main() {
    if (kStep == 0u) rate_rows();
    if (kStep == 1u) choose();
    if (kStep == 2u) sum_tiles();
    if (kStep == 3u) write_rows();
}
