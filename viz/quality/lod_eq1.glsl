// Eq. 1 of Yang, Sander, Lawrence 2008 at one place of the fine picture, a pixel's centre or a
// sample beside it. In scope: LodParams p, the constants kMetric and kKeepBackground; with
// KINO_LOD_OBJECT objects are told apart. Includes lod_guide.glsl, lod_up.glsl.

// What is compared.
struct FineGuide {
    vec2 place;  // fine pixels, centres at integers
    float z;     // metres; 1 where nothing is
    vec3 n;      // view space
    vec2 slope;  // n.xy over its part towards the viewer
};
// Four coarse pixels.
struct CoarseGuides {
    vec4 x, y;     // their numbers
    vec4 z;        // metres
    bvec4 nothing;
    vec4 slope_x, slope_y;
    bvec4 other;  // another object than the fine one's
};

vec2 fine_ray(vec2 place) { return (place - p.fine_k.zw) * p.fine_k.xy; }

// Squared distances, over 2 sigma^2 ln 2: exponents to base 2.
vec4 eq1_exponents(FineGuide i, CoarseGuides j) {
    vec4 ratio = j.z / i.z;
    vec4 d = (1.0 - ratio) * i.z;
    if (kMetric == 1u) d = log2(ratio) * 0.69314718;  // ln z_j - ln z_i
    if (kMetric == 2u) {
        // n_i . (P_i - P_j) / z_i
        vec2 scale = p.fine_k.xy / p.coarse_of_fine.xy;
        vec2 offset = fine_ray(-p.coarse_of_fine.zw / p.coarse_of_fine.xy);
        vec4 along = i.n.x * (j.x * scale.x + offset.x) + i.n.y * (j.y * scale.y + offset.y) +
                     i.n.z;
        vec2 own = i.n.xy * fine_ray(i.place);
        d = (own.x + own.y + i.n.z) - along * ratio;
    }
    vec4 dx = j.slope_x - i.slope.x;
    vec4 dy = j.slope_y - i.slope.y;
    vec4 e = min(d * d * p.z_weight, kFarthest);
    if (kKeepBackground != 0u) e = mix(e, vec4(kNothing), j.nothing);
    e += (dx * dx + dy * dy) * p.n_weight;
#ifdef KINO_LOD_OBJECT
    e += mix(vec4(0.0), vec4(kOtherObject), j.other);
#endif
    return e;
}

// The fine guide as packed coarse ones are compared with it.
FineGuide packed_fine_guide(vec2 place, float z, vec3 n) {
    return FineGuide(place, is_there(z) ? z : 1.0, n, n.xy / max(-n.z, kGuideLeastTowards));
}

// Guide words of coarse pixels x, y; `tags` beside their light, `own_tag` the fine pixel's.
CoarseGuides unpacked_guides(uvec4 guide, vec4 x, vec4 y, vec4 tags, float own_tag) {
    vec4 steps = vec4(guide >> 16);
    CoarseGuides j;
    j.x = x;
    j.y = y;
    j.z = exp2((steps - 1.0) * (1.0 / kGuideStepsPerOctave) + kGuideNearLog2);
    j.nothing = lessThan(steps, vec4(0.5));
    j.slope_x = (vec4(guide & 255u) - 128.0) * (1.0 / kGuideNormalSteps);
    j.slope_y = (vec4((guide >> 8) & 255u) - 128.0) * (1.0 / kGuideNormalSteps);
    j.other = notEqual(tags, vec4(own_tag));
    return j;
}

struct Eq1 {
    vec3 light;  // of the packed coarse picture: light over albedo if fine-grained
    float bits;  // of doubt
};

// The 2x2 packed coarse pixels around `i`. own_tag: object_tag() of the object there.
Eq1 equation_one(FineGuide i, float own_tag, sampler2D coarse_light, usampler2D coarse_guide) {
    Footprint at = footprint_of(i.place, p.coarse_of_fine, p.last);
    ivec2 corner[4] = ivec2[](at.a, ivec2(at.b.x, at.a.y), ivec2(at.a.x, at.b.y), at.b);
    vec4 lit[4];
    for (int j = 0; j < 4; ++j) lit[j] = texelFetch(coarse_light, corner[j], 0);
    uvec4 guide;
    for (int j = 0; j < 4; ++j) guide[j] = texelFetch(coarse_guide, corner[j], 0).r;
    vec4 x = vec4(at.a.x, at.b.x, at.a.x, at.b.x);
    vec4 y = vec4(at.a.y, at.a.y, at.b.y, at.b.y);
    vec4 tags = vec4(lit[0].a, lit[1].a, lit[2].a, lit[3].a);

    Eq1 found;
    vec4 e = eq1_exponents(i, unpacked_guides(guide, x, y, tags, own_tag));
    vec4 w = range_weights(e, tent(at.t));
    found.bits = doubt_bits(e, tent(at.t));
    found.light = vec3(0.0);
    for (int j = 0; j < 4; ++j) found.light += w[j] * lit[j].rgb;
    found.light /= w.x + w.y + w.z + w.w;
    return found;
}

// The same with a Gaussian over the 4x4 around it.
Eq1 equation_one_4x4(FineGuide i, float own_tag, sampler2D coarse_light,
                     usampler2D coarse_guide) {
    Footprint4 at = footprint4_of(i.place, p.coarse_of_fine, p.last);
    vec4 lit[16];
    vec4 e[4];
    float least = 1e30;
    for (int row = 0; row < 4; ++row) {
        uvec4 guide;
        vec4 tags;
        for (int j = 0; j < 4; ++j) {
            ivec2 corner = ivec2(at.x[j], at.y[row]);
            lit[4 * row + j] = texelFetch(coarse_light, corner, 0);
            tags[j] = lit[4 * row + j].a;
            guide[j] = texelFetch(coarse_guide, corner, 0).r;
        }
        e[row] = eq1_exponents(
            i, unpacked_guides(guide, vec4(at.x), vec4(at.y[row]), tags, own_tag));
        least = min(least, least_counting(e[row], at.fx * at.fy[row]));
    }
    Eq1 found;
    found.light = vec3(0.0);
    float sum = 0.0;
    for (int row = 0; row < 4; ++row) {
        vec4 w = at.fx * at.fy[row] * exp2(min(least - e[row], 0.0));
        for (int j = 0; j < 4; ++j) found.light += w[j] * lit[4 * row + j].rgb;
        sum += w.x + w.y + w.z + w.w;
    }
    found.light /= sum;
    found.bits = least - log2(sum);
    return found;
}
