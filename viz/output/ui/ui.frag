#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/output/ui/ui_shared.h"
layout(push_constant, scalar) uniform Push { UiParams p; };
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(location = 0) in vec4 color;
layout(location = 1) in vec2 uv;
layout(location = 0) out vec4 out_srgb;

void main() { out_srgb = color * texture(picture, uv); }
