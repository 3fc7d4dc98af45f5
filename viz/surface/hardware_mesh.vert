#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/hardware_head.glsl"
layout(scalar, set = 0, binding = 0) readonly buffer Depth { float depth_m[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Rays { vec2 rays[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Color { uint color[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Normals { uint normals[]; };
#include "viz/surface/octahedral.glsl"
layout(constant_id = 0) const uint kWantNormal = 0u;
layout(constant_id = 1) const uint kHasColor = 1u;
layout(location = 0) out vec4 v_color;
layout(location = 1) out float v_view_z;
layout(location = 2) out vec3 v_normal;
layout(location = 3) out float v_depth_m;

// One vertex a depth pixel; the index buffer makes two triangles of every cell.
void main() {
    uint i = uint(gl_VertexIndex);
    float z = depth_m[i];
    vec3 v = to_view(p, depth_point(z, rays[i]));
    v_color = kHasColor != 0u ? unpackUnorm4x8(color[i]) : vec4(0.0);
    v_view_z = v.z;
    uint bits = kWantNormal != 0u ? normals[i] : 0x80008000u;
    v_normal = bits != 0x80008000u ? unpack_octahedral(bits) : vec3(0.0);
    v_depth_m = z;
    gl_Position = clip_position(v);
}
