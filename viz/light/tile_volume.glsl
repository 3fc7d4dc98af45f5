// What a tile, or a tile of tiles, may see: four planes through the eye and a range of depths.
layout(constant_id = 0) const uint kTilePx = 16u;
layout(constant_id = 3) const uint kSpots = 0u;
layout(constant_id = 4) const uint kMacroTiles = 4u;  // tiles along a side of a macro tile
#include "viz/light/depth_cells.glsl"

struct TileVolume {
    vec4 slopes;  // x / z of the left and right edge, y / z of the upper and lower one
    vec4 scales;  // 1 / length of the planes' normals (1, 0, -slope)
    float min_z;
    float max_z;
    uint cells;
    float cell_scale;
};

// Edges of the pixels, not their centres: a coarser picture of the same view has its centres
// elsewhere.
TileVolume volume_of_pixels(uvec2 from, uvec2 to, TileBounds bounds) {
    TileVolume v;
    v.slopes.xz = (vec2(from) - 0.5 - p.k.zw) / p.k.xy;
    v.slopes.yw = (vec2(to) - 0.5 - p.k.zw) / p.k.xy;
    v.scales = inversesqrt(1.0 + v.slopes * v.slopes);
    v.min_z = bounds.min_z;
    v.max_z = bounds.max_z;
    v.cells = bounds.cells;
    v.cell_scale = kCells != 0u ? cell_scale(bounds.min_z, bounds.max_z) : 0.0;
    return v;
}

TileBounds bounds_from(uvec4 texel) {
    TileBounds b;
    b.min_z = uintBitsToFloat(texel.x);
    b.max_z = uintBitsToFloat(texel.y);
    b.cells = texel.z;
    b.reserved = 0u;
    return b;
}

// Whether the sphere reaches into the volume. Planes are tight where the depths are far apart, the
// box round the part of the volume at the sphere's depths where they are not.
bool sphere_touches(TileVolume v, vec4 sphere, out vec2 depths, out vec3 low, out vec3 high) {
    vec3 c = sphere.xyz;
    float r = sphere.w;
    vec4 outside = vec4(v.slopes.x * c.z - c.x, c.x - v.slopes.y * c.z,
                        v.slopes.z * c.z - c.y, c.y - v.slopes.w * c.z) * v.scales;
    float z0 = max(v.min_z, c.z - r);
    float z1 = min(v.max_z, c.z + r);
    low = vec3(min(v.slopes.xz * z0, v.slopes.xz * z1), z0);
    high = vec3(max(v.slopes.yw * z0, v.slopes.yw * z1), z1);
    vec3 off = max(max(low - c, c - high), 0.0);
    float across = r * r - off.x * off.x - off.y * off.y;
    float half_depth = sqrt(max(across, 0.0));
    depths = vec2(max(z0, c.z - half_depth), min(z1, c.z + half_depth));
    return max(max(outside.x, outside.y), max(outside.z, outside.w)) <= r &&
           across >= off.z * off.z && z0 <= z1 && depths.x <= depths.y;
}

bool cells_touch(TileVolume v, vec2 depths) {
    return (v.cells & cells_between(cell_of(depths.x, v.min_z, v.cell_scale),
                                    cell_of(depths.y, v.min_z, v.cell_scale))) != 0u;
}

// Whether a spot's cone misses the sphere round the box (Wronski 2017, "Cull that cone").
bool cone_misses(vec3 apex, float reach, vec3 axis, float cone_cos, vec3 low, vec3 high) {
    vec3 center = 0.5 * (low + high);
    float around = 0.5 * length(high - low);
    vec3 way = center - apex;
    float along = dot(way, axis);
    float aside = length(way - along * axis);
    float margin = around + 1e-5 * (length(way) + length(center)) + 1e-4 * reach;
    float cone_sin = sqrt(max(1.0 - cone_cos * cone_cos, 0.0));
    // Cones of nearly half the space or more are left to their spheres.
    return cone_cos > 0.05 && (cone_cos * aside - cone_sin * along > margin || along < -margin ||
                               along > reach + margin);
}
