#include "viz/light/light_shared.h"
#include "viz/light/roll_off.glsl"
#include "viz/light/to_srgb.glsl"

// Exposure, tone map, sRGB and dither of pixel `at`. What shows nothing (alpha 0) is not exposed.
vec4 final_color(vec4 scene, ivec2 at, FinalParams f) {
    vec3 c = scene.rgb * (scene.a > 0.0 ? f.exposure : 1.0);
    if (f.tone_map != 0u && scene.a > 0.0) c = roll_off(c);
    // Interleaved gradient noise (Jimenez 2014) hides the steps of 8 bits; half a step at most.
    float noise = fract(52.9829189 * fract(dot(vec2(at), vec2(0.06711056, 0.00583715))));
    return vec4(to_srgb(c) + (noise - 0.5) / 255.0, 1.0);
}
