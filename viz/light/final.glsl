#include "viz/light/final_color.glsl"
layout(push_constant, scalar) uniform Push { FinalParams p; };
layout(set = 0, binding = 0) uniform sampler2D scene_linear;
#ifdef KINO_EMISSION
layout(set = 0, binding = 1) uniform usampler2D object;
layout(set = 0, binding = 2) uniform usamplerBuffer materials;
#endif
layout(location = 0) out vec4 out_srgb;

// The one last pass: exposure, tone map, sRGB and dither in one go.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 scene = texelFetch(scene_linear, at, 0);
#ifdef KINO_EMISSION
    uint material = texelFetch(object, at, 0).r >> 16u;
    vec3 emitted = uintBitsToFloat(texelFetch(materials, int(3u * material + 1u)).xyz);
    // What emits nothing keeps its alpha: backgrounds are not exposed.
    scene += vec4(emitted, any(greaterThan(emitted, vec3(0.0))) ? 1.0 : 0.0);
#endif
    out_srgb = final_color(scene, at, p);
}
