#ifndef KINO_VIZ_LIGHT_ROLL_OFF_GLSL
#define KINO_VIZ_LIGHT_ROLL_OFF_GLSL
// Linear up to 0.7, then a hyperbola that reaches 1 at infinity with the same slope.
vec3 roll_off(vec3 c) {
    const float kKnee = 0.7;
    vec3 over = max(c - kKnee, 0.0);
    return min(c, kKnee) + (1.0 - kKnee) * over / (over + (1.0 - kKnee));
}
#endif
