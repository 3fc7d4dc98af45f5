#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/light/color.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { SpawnParams p; };
layout(set = 0, binding = 0) uniform sampler2D albedo;
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(set = 0, binding = 2) uniform sampler2D normal;
layout(scalar, set = 0, binding = 3) writeonly buffer Records { LightRecord records[]; };
layout(scalar, set = 0, binding = 4) writeonly buffer Volumes { LightVolume volumes[]; };

const int kTexels = 8;
const float kPi = 3.14159265;

vec3 ray_of(ivec2 at) { return vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0); }

// What a texel returns, as the irradiance that it gives at 1 m along its normal. Lights are in
// units of pi (viz/light/shade.glsl), and a patch gives its radiance times its area over pi.
vec3 flux_of(ivec2 at) {
    float z = texelFetch(view_z, at, 0).r;
    vec3 ray = ray_of(at);
    float stretch = length(ray);
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    float bright = clamp((1.0 / stretch - p.cone_cos) * p.cone_scale, 0.0, 1.0);
    float ratio = dot(ray, ray) * z * z / (p.radius * p.radius);
    float inside = clamp(1.0 - ratio * ratio, 0.0, 1.0);
    float solid_angle = 1.0 / (p.k.x * p.k.y * stretch * stretch * stretch);
    bool faces = z > 0.0 && dot(n, ray) < 0.0;
    vec3 returned = p.color * from_srgb(texelFetch(albedo, at, 0).rgb) *
                    (bright * bright * inside * inside * solid_angle / kPi);
    return faces ? returned : vec3(0.0);
}

float weight_of(vec3 flux) { return max(flux.r, max(flux.g, flux.b)); }

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.grid * p.grid) return;
    ivec2 corner = ivec2(i % p.grid, i / p.grid) * kTexels;
    vec3 sum = vec3(0.0);
    float total = 0.0;
    float depths[kTexels * kTexels];
    float weights[kTexels * kTexels];
    for (int t = 0; t < kTexels * kTexels; ++t) {
        ivec2 at = corner + ivec2(t % kTexels, t / kTexels);
        vec3 flux = flux_of(at);
        sum += flux;
        weights[t] = weight_of(flux);
        depths[t] = texelFetch(view_z, at, 0).r;
        total += weights[t];
    }
    // The texel with half of the flux before it: a real place, whatever depths the block holds.
    int median = 0;
    float nearest_half = 1e30;
    for (int t = 0; t < kTexels * kTexels; ++t) {
        float before = 0.0;
        for (int u = 0; u < kTexels * kTexels; ++u) {
            before += depths[u] < depths[t] || (depths[u] == depths[t] && u < t) ? weights[u] : 0.0;
        }
        float off = abs(before + 0.5 * weights[t] - 0.5 * total);
        if (weights[t] > 0.0 && off < nearest_half) {
            nearest_half = off;
            median = t;
        }
    }
    ivec2 at = corner + ivec2(median % kTexels, median / kTexels);
    vec3 n = from_octahedral(texelFetch(normal, at, 0).rg);
    vec3 place = ray_of(at) * depths[median] + 1e-3 * n;
    vec3 to_source = -normalize(ray_of(at));
    vec3 axis = p.artist != 0u ? normalize(2.0 * dot(n, to_source) * n - to_source) : n;
    vec4 h = vec4(place, 1.0);
    float strength = max(sum.r, max(sum.g, sum.b)) * (p.artist != 0u ? p.gain : 1.0);
    bool shines = strength > 0.0 && strength < 1e30;

    LightRecord light;
    light.place = vec3(dot(p.camera_from_light_x, h), dot(p.camera_from_light_y, h),
                       dot(p.camera_from_light_z, h));
    light.kind = p.artist != 0u ? 2u : 3u;
    light.color = shines ? sum * (p.artist != 0u ? p.gain : 1.0) : vec3(0.0);
    light.radius = shines ? clamp(sqrt(strength / p.cutoff), 1e-3, p.radius) : 1.0;
    light.axis = vec3(dot(p.camera_from_light_x.xyz, axis), dot(p.camera_from_light_y.xyz, axis),
                      dot(p.camera_from_light_z.xyz, axis));
    light.cone_cos = p.artist != 0u ? 0.5 : 0.0;
    light.cone_scale = p.artist != 0u ? 2.0 : 1.0;
    light.material_mask = 0xFFFFFFFFu;
    light.casts_shadow = 0u;
    light.scene_index = 0xFFFFFFFFu;
    records[p.first_record + i] = light;
    // A dark one is nowhere: no tile is within a negative distance.
    volumes[p.first_volume + i] =
        LightVolume(light.place, shines ? light.radius * 1.00001 : -1.0);
}
