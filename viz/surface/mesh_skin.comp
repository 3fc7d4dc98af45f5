#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { MeshSkin p; };
layout(binding = 0) uniform usamplerBuffer static_vertices;
layout(binding = 1) uniform usamplerBuffer weights;
layout(scalar, binding = 2) readonly buffer Joints { vec4 joint_rows[]; };
layout(scalar, binding = 3) writeonly buffer Skinned { vec4 skinned[]; };

// Linear blend skinning of positions and normals, once a frame for every vertex that moves.
void main() {
    uint v = gl_GlobalInvocationID.x;
    if (v >= p.vertices) return;
    int at = int(p.source_first + v) * 2;
    vec4 a = uintBitsToFloat(texelFetch(static_vertices, at));
    vec4 b = uintBitsToFloat(texelFetch(static_vertices, at + 1));
    vec3 normal = vec3(a.w, b.xy);
    int weight_at = int(p.weights_first + v) * 2;
    uvec4 packed = texelFetch(weights, weight_at);
    vec4 w = uintBitsToFloat(texelFetch(weights, weight_at + 1));
    uvec4 joint = uvec4(packed.x & 0xFFFFu, packed.x >> 16, packed.y & 0xFFFFu, packed.y >> 16);
    float sum = w.x + w.y + w.z + w.w;
    // A vertex that no joint wants stays with the root instead of falling into the origin.
    if (!(sum > 0.0)) {
        joint = uvec4(0u);
        w = vec4(1.0, 0.0, 0.0, 0.0);
        sum = 1.0;
    }
    w /= sum;
    vec4 x = vec4(0.0);
    vec4 y = vec4(0.0);
    vec4 z = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        uint row = p.joints_first + 3u * min(joint[k], p.joints - 1u);
        x += w[k] * joint_rows[row];
        y += w[k] * joint_rows[row + 1u];
        z += w[k] * joint_rows[row + 2u];
    }
    vec4 from = vec4(a.xyz, 1.0);
    vec3 position = vec3(dot(x, from), dot(y, from), dot(z, from));
    // Cofactors are the inverse transpose times the determinant, and need no division.
    vec3 cx = cross(y.xyz, z.xyz);
    vec3 n = vec3(dot(cx, normal), dot(cross(z.xyz, x.xyz), normal),
                  dot(cross(x.xyz, y.xyz), normal));
    n *= dot(x.xyz, cx) < 0.0 ? -1.0 : 1.0;
    float squared = dot(n, n);
    n = squared > 0.0 ? n * inversesqrt(squared) : normal;
    uint out_at = (p.target_first + v) * 2u;
    skinned[out_at] = vec4(position, n.x);
    skinned[out_at + 1u] = vec4(n.yz, 0.0, 0.0);
}
