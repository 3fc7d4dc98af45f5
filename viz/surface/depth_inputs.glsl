// What the passes over a depth image read, as texels (gpu::Binding::words says why).
layout(set = 0, binding = 1) uniform usamplerBuffer depth_words;
layout(set = 0, binding = 2) uniform usamplerBuffer ray_pairs;
layout(set = 0, binding = 3) uniform usamplerBuffer color_words;

float depth_at(uint i) { return uintBitsToFloat(texelFetch(depth_words, int(i)).x); }
vec2 ray_at(uint i) { return uintBitsToFloat(texelFetch(ray_pairs, int(i)).xy); }
uint color_at(uint i) { return texelFetch(color_words, int(i)).x; }
