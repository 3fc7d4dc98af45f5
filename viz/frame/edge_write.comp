#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform usamplerBuffer listed;
layout(set = 0, binding = 1) uniform usamplerBuffer state;
layout(set = 0, binding = 2) uniform usamplerBuffer mixed;
layout(set = 0, binding = 3, rgba16f) uniform writeonly image2D linear;

// Mixed colours into their pixels: not before all have read their neighbours.
void main() {
    uint entry = gl_GlobalInvocationID.x;
    if (entry >= texelFetch(state, 3).x) return;
    uint word = texelFetch(listed, int(entry)).x;
    uvec2 c = texelFetch(mixed, int(entry)).xy;
    imageStore(linear, ivec2(word & 0xFFFFu, word >> 16),
               vec4(unpackHalf2x16(c.x), unpackHalf2x16(c.y)));
}
