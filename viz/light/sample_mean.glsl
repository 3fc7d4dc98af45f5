// How a pixel's samples become its colour; in scope kAsShown. Includes light_shared.h, shade.glsl.

// Scene-linear light on its way to the screen: exposed and, unless the mean is of light, toned.
vec3 sample_exposed(vec4 c, FinalParams f) {
    vec3 exposed = c.rgb * (c.a > 0.0 ? f.exposure : 1.0);
    if (kAsShown == 0u) return exposed;
    return f.tone_map != 0u && c.a > 0.0 ? roll_off(exposed) : clamp(exposed, 0.0, 1.0);
}

// What sample_exposed() makes of it; the curve's highest places are as good as infinite.
vec3 unexposed(vec3 c, FinalParams f) {
    const float kKnee = 0.7;
    if (kAsShown != 0u && f.tone_map != 0u) {
        vec3 t = clamp((c - kKnee) / (1.0 - kKnee), 0.0, 0.9995);
        c = min(c, kKnee) + (1.0 - kKnee) * t / (1.0 - t);
    }
    return c / max(f.exposure, 1e-6);
}

// Scene-linear light whose exposed colour is the mean of `count` samples, given the sum of theirs
// and of their alphas. Whatever covers a sample covers the pixel.
vec4 mean_of_samples(vec4 sum, uint count, FinalParams f) {
    vec4 mean = sum / float(count);
    if (mean.a > 0.0) mean.rgb = unexposed(mean.rgb, f);
    return vec4(mean.rgb, mean.a > 0.0 ? 1.0 : 0.0);
}
