#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_fragment.glsl"
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out float out_view_z;
layout(location = 2) out vec2 out_normal;
layout(location = 3) out uint out_id;
layout(location = 4) out uint out_object;

void main() {
    out_albedo = vec4(mesh_to_srgb(mesh_base_color()), 1.0);
    out_view_z = mesh_position().z;
    out_normal = to_octahedral(mesh_normal());
    out_id = uint(gl_PrimitiveID);
    out_object = mesh_object();
}
