// The sRGB transfer function (IEC 61966-2-1), to linear.
vec3 from_srgb(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}
#include "viz/light/to_srgb.glsl"
