#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/surface_shared.h"
layout(push_constant, scalar) uniform Push { SurfaceParams p; };
#include "viz/surface/surface_out.glsl"

void main() {
    out_albedo = vec4(background_at(gl_FragCoord.y / float(p.target.y)), 0.0);
    out_view_z = 0.0;
    out_normal = vec2(0.0);
    out_id = KINO_EMPTY;
}
