#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/hardware_head.glsl"
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
layout(location = 0) in vec4 v_color[];
layout(location = 1) in float v_view_z[];
layout(location = 2) in vec3 v_normal[];
layout(location = 3) in float v_depth_m[];
layout(location = 0) out vec4 g_color;
layout(location = 1) out float g_view_z;
layout(location = 2) out vec3 g_normal;
layout(location = 3) flat out uint g_id;

// Lets a triangle through only where its corners belong to one surface.
void main() {
    if (!keep_triangle(p, v_depth_m[0], v_depth_m[1], v_depth_m[2])) return;
    for (int k = 0; k < 3; ++k) {
        gl_Position = gl_in[k].gl_Position;
        g_color = v_color[k];
        g_view_z = v_view_z[k];
        g_normal = v_normal[k];
        g_id = uint(gl_PrimitiveIDIn);
        EmitVertex();
    }
    EndPrimitive();
}
