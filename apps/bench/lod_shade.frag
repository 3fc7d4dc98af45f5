#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "apps/bench/lod_stage_shared.h"
#include "viz/surface/octahedral.glsl"
layout(push_constant, scalar) uniform Push { LodStageParams p; };
layout(constant_id = 0) const uint kKind = 0;
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(scalar, set = 0, binding = 3) readonly buffer Things { vec4 things[]; };
layout(location = 0) out vec4 out_linear;

vec3 from_srgb(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

// 1 where a ray from q along d misses all balls.
float free_way(vec3 q, vec3 d) {
    float free = 1.0;
    for (int i = 0; i < (kKind == 0u ? 4 : 8); ++i) {
        vec3 c = things[i].xyz - q;
        float along = dot(c, d);
        float miss = dot(c, c) - along * along - things[i].w * things[i].w;
        free *= along > 1e-3 && miss < 0.0 ? 0.0 : 1.0;
    }
    return free;
}

vec3 around(vec3 axis, vec3 v) {
    vec3 side = normalize(cross(axis, abs(axis.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    return side * v.x + cross(axis, side) * v.y + axis * v.z;
}

float soft_shadow(vec3 q, vec3 to_light) {
    float sum = 0.0;
    float middle = 0.5 * float(p.trips - 1u);
    for (uint i = 0u; i < p.trips * p.trips; ++i) {
        vec2 at = (vec2(i % p.trips, i / p.trips) - middle) / max(middle, 1.0);
        sum += free_way(q, normalize(around(to_light, vec3(0.16 * at, 1.0))));
    }
    return sum / float(p.trips * p.trips);
}

float hash(vec3 v) {
    v = fract(v * vec3(0.1031, 0.1030, 0.0973));
    v += dot(v, v.yzx + 33.33);
    return fract((v.x + v.y) * v.z);
}
float noise(vec3 v) {
    vec3 i = floor(v);
    vec3 f = fract(v);
    f = f * f * (3.0 - 2.0 * f);
    vec4 back = vec4(hash(i), hash(i + vec3(1, 0, 0)), hash(i + vec3(0, 1, 0)),
                     hash(i + vec3(1, 1, 0)));
    vec4 front = vec4(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), hash(i + vec3(0, 1, 1)),
                      hash(i + vec3(1, 1, 1)));
    vec4 z = mix(back, front, f.z);
    vec2 y = mix(z.xy, z.zw, f.y);
    return mix(y.x, y.y, f.x);
}
float marble(vec3 q) {
    float sum = 0.0;
    float weight = 0.5;
    float frequency = 1.6;
    for (uint i = 0u; i < p.trips; ++i) {
        sum += weight * noise(q * frequency + float(i) * 17.0);
        weight *= 0.62;
        frequency *= 1.37;
    }
    return 0.5 + 0.5 * sin(3.0 * q.x + 5.0 * sum);
}

float open_sky(vec3 q, vec3 n) {
    float sum = 0.0;
    for (uint i = 0u; i < p.trips; ++i) {
        float up = (float(i) + 0.5) / float(p.trips);
        float turn = 2.3999632 * float(i);
        float flat_part = sqrt(up);
        vec3 d = around(n, vec3(cos(turn) * flat_part, sin(turn) * flat_part, sqrt(1.0 - up)));
        sum += free_way(q, d);
    }
    return sum / float(p.trips);
}

vec3 many_lights(vec3 q, vec3 n) {
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < p.trips; ++i) {
        vec3 to = things[2u * i].xyz - q;
        float squared = dot(to, to);
        float towards = max(dot(n, to) * inversesqrt(squared), 0.0);
        float ratio = squared / (things[2u * i].w * things[2u * i].w);
        float inside = clamp(1.0 - ratio * ratio, 0.0, 1.0);
        sum += things[2u * i + 1u].rgb * towards * inside * inside / max(squared, 0.01);
    }
    return sum;
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 seen = texelFetch(albedo, at, 0);
    vec3 base = from_srgb(seen.rgb);
    float z = texelFetch(view_z, at, 0).r;
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 ray = vec3((vec2(at) - p.k.zw) * p.k.xy, 1.0);
    vec3 q = ray * z + n * 1e-3;
    // The car's sun stands aside, so that its shadows fall across the picture.
    vec3 to_light =
        normalize(kKind == 0u ? vec3(0.8, -0.55, -0.1) : vec3(-0.5, -0.8, -0.45));
    float towards = max(dot(n, to_light), 0.0);
    vec3 light = vec3(0.0);
    vec3 shine = vec3(0.0);
    if (kKind == 0u) light = vec3(0.12, 0.13, 0.15) + 0.85 * towards * soft_shadow(q, to_light);
    if (kKind == 1u) {
        light = (0.15 + 0.7 * towards) * (0.35 + 0.65 * marble(q)) * vec3(1.0, 0.95, 0.85);
        vec3 half_way = normalize(to_light - normalize(ray));
        shine = vec3(0.25 * pow(max(dot(n, half_way), 0.0), 24.0));
    }
    if (kKind == 2u) light = vec3(0.6 * open_sky(q, n) + 0.3 * towards);
    if (kKind == 3u) light = 0.1 + many_lights(q, n);
    out_linear = vec4(seen.a > 0.0 ? base * light + shine : base, seen.a);
}
