#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_fragment.glsl"
#include "viz/surface/sample_surface.glsl"
layout(location = 0) out vec4 out_texel;

// Once a pixel, for all samples that the triangle covers.
void main() {
    out_texel = packed_sample(mesh_object(), to_octahedral(mesh_normal()), mesh_position().z,
                              vec4(mesh_albedo(), 1.0));
}
