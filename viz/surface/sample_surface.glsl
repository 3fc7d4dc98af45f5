// The thin surface in one texel a sample, four floats: pictures of integers need not have several
// samples, and whole numbers of 24 bits are exact in a float. Includes octahedral.glsl.
//   r  metres along the view axis       g  normal, octahedral in 12 + 12 bits
//   b  material << 16 | object id       a  sRGB in 8 + 8 + 8 bits, background: -1 minus that, or
//                                          where it is not stored (is_backdrop) far below
#include "viz/surface/sample_backdrop.h"
vec4 packed_sample(uint object, vec2 octahedral, float view_z, vec4 albedo) {
    vec2 steps = round((clamp(octahedral, -1.0, 1.0) * 0.5 + 0.5) * 4095.0);
    vec3 bytes = round(clamp(albedo.rgb, 0.0, 1.0) * 255.0);
    float color = (bytes.r * 256.0 + bytes.g) * 256.0 + bytes.b;
    return vec4(view_z, steps.y * 4096.0 + steps.x, float(object),
                albedo.a > 0.0 ? color : -1.0 - color);
}

float sample_z(vec4 texel) { return texel.r; }
vec3 sample_normal(vec4 texel) {
    uint steps = uint(texel.g);
    return from_octahedral(vec2(steps & 4095u, steps >> 12) * (2.0 / 4095.0) - 1.0);
}
bool is_backdrop(vec4 texel) { return texel.a <= -KINO_BACKDROP_COLOR; }
uint sample_object(vec4 texel) { return uint(texel.b); }
vec4 sample_albedo(vec4 texel) {
    uint color = uint(texel.a < 0.0 ? -1.0 - texel.a : texel.a);
    uvec3 bytes = uvec3(color >> 16, color >> 8, color) & 255u;
    return vec4(vec3(bytes) / 255.0, texel.a < 0.0 ? 0.0 : 1.0);
}
