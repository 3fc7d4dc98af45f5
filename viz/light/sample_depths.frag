#version 460
layout(push_constant) uniform Push { float near_m; };
layout(set = 0, binding = 0) uniform sampler2DMS depth;
layout(location = 0) out float out_view_z;

// View depths of a pixel's four samples as 2 x 2 pixels of a picture twice as large, about where
// the samples lie (Vulkan's standard locations).
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    float d = texelFetch(depth, at >> 1, (at.y & 1) * 2 + (at.x & 1)).r;
    out_view_z = d > 0.0 ? near_m / d : 0.0;
}
