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
layout(location = 3) flat out uint v_id;

void main() {
    uint i = uint(gl_VertexIndex);
    float z = depth_m[i];
    vec3 v = to_view(p, depth_point(z, rays[i]));
    v_color = kHasColor != 0u ? unpackUnorm4x8(color[i]) : vec4(0.0);
    v_view_z = v.z;
    v_normal = kWantNormal != 0u ? unpack_octahedral(normals[i]) : vec3(0.0, 0.0, -1.0);
    v_id = i;
    // Points without a reading go behind the near plane, where they are clipped.
    gl_Position = z > 0.0 ? clip_position(v) : vec4(0.0, 0.0, 2.0, 1.0);
    float footprint = p.k.x * z / (p.depth_focal_px * max(v.z, p.near_m));
    gl_PointSize = clamp(ceil(footprint), 1.0, float(p.splat_cap_px));
}
