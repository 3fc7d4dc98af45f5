#version 460
#extension GL_GOOGLE_include_directive : require
layout(set = 0, binding = 0) uniform usampler2D object;
layout(set = 0, binding = 1) uniform usamplerBuffer materials;
layout(location = 0) out vec4 out_linear;

void main() {
    uint material = texelFetch(object, ivec2(gl_FragCoord.xy), 0).r >> 16u;
    vec3 emitted = uintBitsToFloat(texelFetch(materials, int(3u * material + 1u)).xyz);
    // What emits nothing keeps its alpha: backgrounds are not exposed.
    out_linear = vec4(emitted, any(greaterThan(emitted, vec3(0.0))) ? 1.0 : 0.0);
}
