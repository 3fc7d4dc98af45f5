#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/output/ui/ui_shared.h"
layout(push_constant, scalar) uniform Push { UiParams p; };
layout(location = 0) in vec2 in_position;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec4 in_color;
layout(location = 0) out vec4 color;
layout(location = 1) out vec2 uv;

void main() {
    color = in_color;
    uv = in_uv;
    gl_Position = vec4(in_position * p.scale + p.offset, 0.0, 1.0);
}
