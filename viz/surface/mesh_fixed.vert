#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// The rival of vertex pulling: vertices come through the fixed-function vertex input.
#include "viz/surface/mesh_vertex.glsl"
layout(binding = 0) uniform usamplerBuffer draw_rows;
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec2 a_uv;

void main() {
    int at = int(gl_InstanceIndex) * 8;
    place_vertex(a_position, a_normal, a_uv, texelFetch(draw_rows, at),
                 texelFetch(draw_rows, at + 1), texelFetch(draw_rows, at + 2),
                 texelFetch(draw_rows, at + 3), texelFetch(draw_rows, at + 4),
                 texelFetch(draw_rows, at + 5));
}
