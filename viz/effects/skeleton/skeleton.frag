#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/effects/skeleton/skeleton_shared.h"
layout(push_constant, scalar) uniform Push { SkeletonParams p; };
layout(scalar, set = 0, binding = 0) readonly buffer Capsules { CapsuleRecord capsules[]; };
layout(set = 0, binding = 1) uniform sampler2D view_z;
layout(location = 0) flat in uint v_capsule;
layout(location = 0) out vec4 out_color;

// Where the pixel's ray passes nearest to the bone's axis decides everything: whether it hits,
// how far along it is, and how the round surface is lit there. What lies inside the body shows as
// a dimmed overlay.
void main() {
    CapsuleRecord c = capsules[v_capsule];
    vec3 ray = normalize(vec3((gl_FragCoord.xy - 0.5 - p.k.zw) / p.k.xy, 1.0));
    vec3 axis = c.b - c.a;
    float axis2 = dot(axis, axis);
    float r_dot_axis = dot(ray, axis);
    // Closest point of the segment to the ray through the eye (which is the origin).
    float s = 0.0;
    if (axis2 > 1e-8) {
        float denominator = axis2 - r_dot_axis * r_dot_axis;
        s = (r_dot_axis * dot(ray, c.a) - dot(axis, c.a)) / max(denominator, 1e-8);
        s = clamp(s, 0.0, 1.0);
    }
    vec3 q = c.a + s * axis;
    float t = dot(ray, q);
    vec3 off = ray * t - q;
    float distance2 = dot(off, off);
    float radius = mix(c.radius_a, c.radius_b, s);
    float inside = radius * radius - distance2;
    float pixel = t / p.k.x;  // metres a pixel is wide there
    float coverage = clamp((radius - sqrt(distance2)) / pixel + 0.5, 0.0, 1.0);
    if (c.dashed > 0.0 && axis2 > 1e-8) {
        // Dashes of 3 cm; thinner than the solid bone would be.
        coverage *= step(0.5, fract(s * sqrt(axis2) / 0.06 + 0.25));
    }
    float depth_into = sqrt(max(inside, 0.0));
    vec3 n = (off - ray * depth_into) / max(radius, 1e-5);
    float lit = 0.45 + 0.55 * clamp(dot(n, normalize(vec3(-0.4, -0.7, -0.6))), 0.0, 1.0);
    float z = (ray * (t - depth_into)).z;
    float surface = texelFetch(view_z, ivec2(gl_FragCoord.xy), 0).r;
    float visible = surface > 0.0 && z > surface ? p.dimmed : 1.0;
    out_color = vec4(c.color * lit, coverage * visible);
}
