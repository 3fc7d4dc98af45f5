#version 460
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(location = 0) out vec4 out_linear;

// A picture into every sample of its pixels.
void main() { out_linear = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
