#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/compute_head.glsl"
#include "viz/light/light_shared.h"
// Light at the rate of depth pixels: each gets its final colour before it is drawn, so that the
// picture costs no more than an unlit one. Diffuse light changes slowly over a surface; what is
// lost is measured against light.frag (docs/accuracy).
layout(scalar, set = 0, binding = 0) writeonly buffer Lit { uint lit[]; };
#include "viz/surface/depth_inputs.glsl"
layout(scalar, set = 0, binding = 4) readonly buffer Normals { uint normals[]; };
layout(scalar, set = 0, binding = 5) readonly buffer Params { PointLightParams scene; };
layout(scalar, set = 0, binding = 6) readonly buffer Lights { LightRecord lights[]; };

layout(constant_id = 1) const uint kHasColor = 1u;
#include "viz/light/color.glsl"
#include "viz/light/shade.glsl"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/payload.glsl"

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= p.grid.x) return;
    uint i = at.y * p.grid.x + at.x;
    float z = depth_at(i);
    vec3 q = to_view(p, depth_point(z, KINO_RAY(at, i)));
    uint bits = normals[i];
    vec3 n = bits != 0x80008000u ? unpack_octahedral(bits) : -normalize(q);
    vec3 captured = from_srgb(unpackUnorm4x8(kHasColor != 0u ? opaque(color_at(i)) : kUncolouredBits).rgb);
    vec3 irradiance = scene.mixed != 0u ? vec3(1.0) : scene.ambient;
    uint count = z > 0.0 ? scene.count : 0u;
    for (uint k = 0u; k < count; ++k) irradiance += light_at(lights[k], q, n);
    vec3 c = roll_off(captured * irradiance * scene.exposure);
    lit[i] = packUnorm4x8(vec4(to_srgb(c), 1.0));
}
