#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/hardware_head.glsl"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/surface_out.glsl"
layout(location = 0) in vec4 v_color;
layout(location = 1) in float v_view_z;
layout(location = 2) in vec3 v_normal;
layout(location = 3) flat in uint v_id;

void main() {
    vec3 ray = vec3((gl_FragCoord.xy - 0.5 - p.k.zw) / p.k.xy, 1.0);
    out_albedo = vec4(v_color.a > 0.001 ? v_color.rgb / v_color.a : kUncoloured, 1.0);
    out_view_z = v_view_z;
    out_id = v_id;
    out_normal = to_octahedral(dot(v_normal, v_normal) > 1e-6 ? normalize(v_normal)
                                                              : -normalize(ray));
}
