#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_shared.h"
layout(push_constant, scalar) uniform Push { MeshView view; };
layout(binding = 0) uniform sampler2D view_z;

void main() {
    float z = texelFetch(view_z, ivec2(gl_FragCoord.xy), 0).x;
    gl_FragDepth = z > 0.0 ? min(view.near_m / z, 1.0) : 0.0;
}
