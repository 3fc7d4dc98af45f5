#version 460
#include "viz/accel/accel_head.glsl"
// Box of the centroids. Each lane takes every p.lanes-th triangle and joins its own box to the
// common one. Highest places are kept as complements, so that one fill begins and one minimum joins.
layout(local_size_x = 8) in;
layout(scalar, set = 0, binding = 0) readonly buffer Soup { SoupTriangle soup[]; };
layout(scalar, set = 0, binding = 1) buffer Keys { uint keys[6]; };

void main() {
    uvec3 low = uvec3(0xFFFFFFFFu);
    uvec3 high = uvec3(0xFFFFFFFFu);
    for (uint i = gl_GlobalInvocationID.x; i < p.triangles; i += p.lanes) {
        vec3 at = centroid_of(soup[i]);
        uvec3 key = uvec3(key_of(at.x), key_of(at.y), key_of(at.z));
        low = min(low, key);
        high = min(high, ~key);
    }
    for (uint k = 0u; k < 3u; ++k) {
        atomicMin(keys[k], low[k]);
        atomicMin(keys[3u + k], high[k]);
    }
}
