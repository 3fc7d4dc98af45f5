#version 460
layout(push_constant) uniform Push { uint sample_index; uint width; uint pixels; };
layout(set = 0, binding = 0) uniform usamplerBuffer texels;
layout(location = 0) out vec4 out_texel;

// One sample of every pixel, as the host holds it.
void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    out_texel = uintBitsToFloat(
        texelFetch(texels, int(sample_index * pixels + at.y * width + at.x)));
    gl_SampleMask[0] = 1 << sample_index;
}
