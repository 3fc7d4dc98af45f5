#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/sample_surface.glsl"
layout(push_constant, scalar) uniform Push { MeshView view; };
layout(binding = 0) uniform sampler2D albedo;
layout(binding = 1) uniform sampler2D view_z;
layout(binding = 2) uniform sampler2D normal;
layout(location = 0) out vec4 out_texel;

// What has one sample into all of a pixel's.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float z = texelFetch(view_z, at, 0).x;
    out_texel = packed_sample(0u, texelFetch(normal, at, 0).rg, z, texelFetch(albedo, at, 0));
    gl_FragDepth = z > 0.0 ? min(view.near_m / z, 1.0) : 0.0;
}
