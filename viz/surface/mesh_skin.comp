#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_shared.h"
layout(local_size_x = 64) in;
// KINO_SKIN_*: code that is not asked for is not compiled.
layout(constant_id = 0) const uint kBlend = KINO_SKIN_LINEAR;
layout(push_constant, scalar) uniform Push { MeshSkin p; };
layout(binding = 0) uniform usamplerBuffer static_vertices;
layout(binding = 1) uniform usamplerBuffer weights;
layout(scalar, binding = 2) readonly buffer Joints { vec4 joint_rows[]; };
layout(scalar, binding = 3) writeonly buffer Skinned { vec4 skinned[]; };

// Quaternions here are (x, y, z, w).
vec4 product(vec4 a, vec4 b) {
    return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}
vec3 turned(vec4 q, vec3 v) {
    vec3 t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}

// Cofactors are the inverse transpose times the determinant, and need no division.
vec3 cofactor(vec3 x, vec3 y, vec3 z, vec3 normal) {
    vec3 cx = cross(y, z);
    vec3 n = vec3(dot(cx, normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
    return dot(x, cx) < 0.0 ? -n : n;
}

// Skinning of positions and normals, once a frame for every vertex that moves.
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
    joint = min(joint, uvec4(p.joints - 1u));
    vec4 from = vec4(a.xyz, 1.0);
    vec3 position;
    vec3 n;
    if (kBlend == KINO_SKIN_LINEAR) {
        vec4 x = vec4(0.0);
        vec4 y = vec4(0.0);
        vec4 z = vec4(0.0);
        for (int k = 0; k < 4; ++k) {
            uint row = p.joints_first + KINO_SKIN_LINEAR_ROWS * joint[k];
            x += w[k] * joint_rows[row];
            y += w[k] * joint_rows[row + 1u];
            z += w[k] * joint_rows[row + 2u];
        }
        position = vec3(dot(x, from), dot(y, from), dot(z, from));
        n = cofactor(x.xyz, y.xyz, z.xyz, normal);
    } else {
        // Kavan et al. 2008, with the origin of every joint's dual quaternion in the vertex: joint
        // k turns by q and takes the vertex to `to`, so its dual part is (to q) / 2. A joint's scale
        // thus is in `to`, blended linearly, and where joints agree on a point it stays there.
        uint first = w.y > w.x ? 1u : 0u;
        first = w.z > w[first] ? 2u : first;
        first = w.w > w[first] ? 3u : first;
        vec4 pivot =
            joint_rows[p.joints_first + KINO_SKIN_DUAL_ROWS * joint[first] + 3u];
        vec4 real = vec4(0.0);
        vec4 dual = vec4(0.0);
        vec3 unturned = vec3(0.0);
        for (int k = 0; k < 4; ++k) {
            uint row = p.joints_first + KINO_SKIN_DUAL_ROWS * joint[k];
            vec4 x = joint_rows[row];
            vec4 y = joint_rows[row + 1u];
            vec4 z = joint_rows[row + 2u];
            vec4 q = joint_rows[row + 3u];
            vec3 to = vec3(dot(x, from), dot(y, from), dot(z, from));
            // q and -q are one rotation: the one on the strongest joint's side is the short way.
            vec4 weighted = (dot(q, pivot) < 0.0 ? -w[k] : w[k]) * q;
            real += weighted;
            dual += product(vec4(to, 0.0), weighted);
            vec3 back = cofactor(x.xyz, y.xyz, z.xyz, normal);
            unturned += w[k] * turned(vec4(-q.xyz, q.w), back);
        }
        // The pivot's weight is at least a quarter, and nothing opposes it.
        position = product(dual, vec4(-real.xyz, real.w)).xyz / dot(real, real);
        n = turned(normalize(real), unturned);
    }
    float squared = dot(n, n);
    n = squared > 0.0 ? n * inversesqrt(squared) : normal;
    uint out_at = (p.target_first + v) * 2u;
    skinned[out_at] = vec4(position, n.x);
    skinned[out_at + 1u] = vec4(n.yz, 0.0, 0.0);
}
