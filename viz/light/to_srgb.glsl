#ifndef KINO_VIZ_LIGHT_TO_SRGB_GLSL
#define KINO_VIZ_LIGHT_TO_SRGB_GLSL
// The sRGB transfer function (IEC 61966-2-1), from linear.
vec3 to_srgb(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}
#endif
