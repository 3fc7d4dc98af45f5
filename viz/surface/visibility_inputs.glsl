// The visibility buffer of the passes that read it: {payload, depth bits} a pixel.
layout(set = 0, binding = 0) uniform usamplerBuffer visibility_pairs;

uvec2 visibility_at(uint i) { return texelFetch(visibility_pairs, int(i)).xy; }
