#include "viz/quality/lod_fix_shared.h"
// Where a fine pixel lies among the coarse ones: the 2x2 around it and their tent weights.
struct Footprint {
    ivec2 a;  // upper left and
    ivec2 b;  // lower right coarse pixel, inside the picture
    vec2 t;   // place between them
};
Footprint footprint_of(vec2 fine, vec4 coarse_of_fine, ivec2 last) {
    vec2 x = fine * coarse_of_fine.xy + coarse_of_fine.zw;
    vec2 base = floor(x);
    ivec2 b = ivec2(base);
    return Footprint(clamp(b, ivec2(0), last), clamp(b + 1, ivec2(0), last), x - base);
}
vec4 tent(vec2 t) {
    vec2 s = 1.0 - t;
    return vec4(s.x * s.y, t.x * s.y, s.x * t.y, t.x * t.y);
}
// The light there, by the tent alone.
vec3 tent_light(sampler2D coarse_light, Footprint at) {
    vec4 f = tent(at.t);
    return f.x * texelFetch(coarse_light, at.a, 0).rgb +
           f.y * texelFetch(coarse_light, ivec2(at.b.x, at.a.y), 0).rgb +
           f.z * texelFetch(coarse_light, ivec2(at.a.x, at.b.y), 0).rgb +
           f.w * texelFetch(coarse_light, at.b, 0).rgb;
}
// Squared distances end here, so that nothing overflows, and hard filters lie beyond.
const float kFarthest = 1e4;
const float kOtherObject = 1e4;
const float kNothing = 2e4;

// The 4x4 coarse pixels around a fine one and their weights along either axis, a Gaussian's.
struct Footprint4 {
    ivec4 x, y;  // inside the picture
    vec4 fx, fy;
};
vec4 gauss_along(float t) {
    vec4 d = t + vec4(1.0, 0.0, -1.0, -2.0);
    vec4 f = exp2(d * d * (-0.72134752 / (kGaussSigma * kGaussSigma)));
    return f / (f.x + f.y + f.z + f.w);
}
Footprint4 footprint4_of(vec2 fine, vec4 coarse_of_fine, ivec2 last) {
    vec2 x = fine * coarse_of_fine.xy + coarse_of_fine.zw;
    vec2 base = floor(x);
    ivec2 b = ivec2(base);
    const ivec4 kSteps = ivec4(-1, 0, 1, 2);
    return Footprint4(clamp(b.x + kSteps, ivec4(0), ivec4(last.x)),
                      clamp(b.y + kSteps, ivec4(0), ivec4(last.y)), gauss_along(x.x - base.x),
                      gauss_along(x.y - base.y));
}

// Weights of the range filter by the squared distances `e` (in units of their logarithm to base
// 2). The nearest sample that counts has 1: where all are far, it alone is left.
float least_counting(vec4 e, vec4 f) {
    vec4 counting = mix(vec4(1e30), e, greaterThanEqual(f, vec4(1e-3)));
    return min(min(counting.x, counting.y), min(counting.z, counting.w));
}
vec4 range_weights(vec4 e, vec4 f) {
    return f * exp2(min(least_counting(e, f) - e, 0.0));
}

// -log2 of the confidence, the sum of the weights before the least distance was taken off.
float doubt_bits(vec4 e, vec4 f) {
    vec4 w = range_weights(e, f);
    return least_counting(e, f) - log2(w.x + w.y + w.z + w.w);
}

// Doubt of viz/quality/lod_fix_shared.h over 255.
float doubt_of(float bits) {
    return min(round(kDoubtSteps * sqrt(max(bits, 0.0))), kMostDoubt) / 255.0;
}
