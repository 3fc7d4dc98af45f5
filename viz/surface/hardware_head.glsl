// The chapter's pipeline on fixed-function rasterisation, kept as the reference for the compute
// paths: --raster hardware.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/surface_shared.h"
layout(push_constant, scalar) uniform Push { SurfaceParams p; };
#include "viz/surface/depth_grid.glsl"

// Reversed depth without a far plane: near -> 1, infinity -> 0.
vec4 clip_position(vec3 v) {
    vec2 size = vec2(p.target);
    return vec4(2.0 * (p.k.xy * v.xy + (p.k.zw + 0.5) * v.z) / size - v.z, p.near_m, v.z);
}
