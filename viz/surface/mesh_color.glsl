// The sRGB transfer functions for mesh shaders.
#ifndef KINO_MESH_COLOR_GLSL
#define KINO_MESH_COLOR_GLSL
vec3 mesh_to_linear(vec3 c) {
    return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}
vec3 mesh_to_srgb(vec3 c) {
    c = max(c, vec3(0.0));
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92,
               lessThanEqual(c, vec3(0.0031308)));
}
#endif
