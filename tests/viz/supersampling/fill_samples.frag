#version 460
layout(push_constant) uniform Push { uint sample_index; uint width; uint pixels; };
layout(set = 0, binding = 0) uniform usamplerBuffer texels;
layout(location = 0) out vec4 out_identity;
layout(location = 1) out vec2 out_place;

// One sample of every pixel, as the host holds it: 16 bits twice, two floats.
void main() {
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec4 t = texelFetch(texels, int(sample_index * pixels + at.y * width + at.x));
    out_identity =
        vec4(t.x & 0xFFFFu, t.x >> 16, t.y & 0xFFFFu, t.y >> 16) / 65535.0;
    out_place = uintBitsToFloat(t.zw);
    gl_SampleMask[0] = 1 << sample_index;
}
