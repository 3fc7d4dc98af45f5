#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/effects/skeleton/skeleton_shared.h"
layout(push_constant, scalar) uniform Push { SkeletonParams p; };
layout(scalar, set = 0, binding = 0) readonly buffer Capsules { CapsuleRecord capsules[]; };
layout(location = 0) flat out uint v_capsule;

// A rectangle along the capsule, just large enough for its outline; two triangles an instance.
void main() {
    CapsuleRecord c = capsules[gl_InstanceIndex];
    v_capsule = uint(gl_InstanceIndex);
    vec2 pa = p.k.xy * c.a.xy / c.a.z + p.k.zw + 0.5;
    vec2 pb = p.k.xy * c.b.xy / c.b.z + p.k.zw + 0.5;
    vec2 along = pb - pa;
    float squared = dot(along, along);
    along = squared > 1e-6 ? along * inversesqrt(squared) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    float grow = 1.5 + 1.15 * max(p.k.x, p.k.y) * max(c.radius_a / c.a.z, c.radius_b / c.b.z);
    // Corners of the two triangles: (-,-) (+,-) (-,+) and (+,-) (+,+) (-,+).
    const vec2 kCorners[6] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(-1, 1),
                                    vec2(1, -1), vec2(1, 1), vec2(-1, 1));
    vec2 corner = kCorners[gl_VertexIndex];
    vec2 at = (corner.x < 0.0 ? pa : pb) + grow * (along * corner.x + across * corner.y);
    gl_Position = vec4(2.0 * at / p.target - 1.0, 0.5, 1.0);
}
