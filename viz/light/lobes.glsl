// Lobes of a layered material; pi is folded into the lights' unit, as for Lambert. `towards` is
// n.l, at least 0. Kinds that no material of the scene has are compiled out.
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 6) const uint kLobeKinds = 0u;

struct Lobe {
    vec3 color;
    uint kind;  // as LobeKind
    vec3 grazing;
    float roughness;
};

// Oren and Nayar 1994, the qualitative model.
vec3 oren_nayar(Lobe lobe, vec3 n, vec3 v, vec3 l, float towards) {
    float facing = max(dot(n, v), 0.0);
    float s2 = lobe.roughness * lobe.roughness;
    float a = 1.0 - 0.5 * s2 / (s2 + 0.33);
    float b = 0.45 * s2 / (s2 + 0.09);
    float s = dot(l, v) - towards * facing;
    float t = s > 0.0 ? max(max(towards, facing), 1e-4) : 1.0;
    return lobe.color * (towards * max(a + b * s / t, 0.0));
}

// Trowbridge-Reitz facets, height-correlated Smith shadowing, Schlick's Fresnel (Walter et al.
// 2007, Heitz 2014, Schlick 1994).
vec3 ggx(Lobe lobe, vec3 n, vec3 v, vec3 l, float towards) {
    float facing = max(dot(n, v), 1e-4);
    vec3 h = normalize(v + l + vec3(0.0, 0.0, 1e-12));
    float on_facet = clamp(dot(n, h), 0.0, 1.0);
    float alpha = lobe.roughness * lobe.roughness;
    float a2 = alpha * alpha;
    float d = on_facet * on_facet * (a2 - 1.0) + 1.0;
    float shadowing = towards * sqrt(facing * facing * (1.0 - a2) + a2) +
                      facing * sqrt(towards * towards * (1.0 - a2) + a2);
    float miss = 1.0 - clamp(dot(v, h), 0.0, 1.0);
    float miss2 = miss * miss;
    vec3 fresnel = lobe.color + lobe.grazing * (miss2 * miss2 * miss);
    return fresnel * (towards * a2 / (d * d) * 0.5 / max(shadowing, 1e-6));
}

vec3 rim(Lobe lobe, vec3 n, vec3 v, float towards) {
    float away = clamp(1.0 - dot(n, v), 0.0, 1.0);
    return lobe.color * (towards * pow(away, 1.0 / lobe.roughness));
}

// Light that a lobe sends to the eye; `base` is the surface's colour.
vec3 lobe_light(Lobe lobe, vec3 base, vec3 n, vec3 v, vec3 l, float towards) {
    vec3 light = vec3(0.0);
    if ((kLobeKinds & 2u) != 0u && lobe.kind == 1u) light = base * oren_nayar(lobe, n, v, l, towards);
    if ((kLobeKinds & 4u) != 0u && lobe.kind == 2u) light = ggx(lobe, n, v, l, towards);
    if ((kLobeKinds & 8u) != 0u && lobe.kind == 3u) light = rim(lobe, n, v, towards);
    return light;
}
