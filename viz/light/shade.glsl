// Diffuse light at a point q with normal n, both in view space; linear. An irradiance of 1 at
// normal incidence returns the albedo: the pi of the diffuse lobe is folded into the lights' unit.
vec3 light_at(LightRecord light, vec3 q, vec3 n) {
    vec3 to_light = light.kind != 0u ? light.place - q : light.place;
    float squared = max(dot(to_light, to_light), 1e-6);
    float towards = max(dot(n, to_light) * inversesqrt(squared), 0.0);
    float ratio = squared / (light.radius * light.radius);
    float inside = clamp(1.0 - ratio * ratio, 0.0, 1.0);
    float falloff = light.kind != 0u ? inside * inside / max(squared, 0.01) : 1.0;
    float cone = clamp((-dot(to_light, light.axis) * inversesqrt(squared) - light.cone_cos) *
                           light.cone_scale, 0.0, 1.0);
    return light.color * towards * (light.kind == 2u ? falloff * cone * cone : falloff);
}

#include "viz/light/roll_off.glsl"
