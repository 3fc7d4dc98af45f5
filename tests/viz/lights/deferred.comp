#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/octahedral.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { CullParams p; };
layout(set = 0, binding = 0) uniform sampler2D view_z;
layout(set = 0, binding = 1) uniform sampler2D normal;
layout(set = 0, binding = 2) uniform usamplerBuffer volumes;
layout(set = 0, binding = 3) uniform usamplerBuffer lights;
layout(scalar, set = 0, binding = 4) writeonly buffer Lit { vec4 irradiance[]; };
#include "viz/light/tile_volume.glsl"

shared uint nearest;
shared uint farthest;
shared uint listed;
shared uint list[1024];

// Compute-based deferred lighting as the chapter measures it: one work group an 8x8 tile finds its
// depths, culls all lights into shared memory and adds up their light for its pixels.
void main() {
    uint lane = gl_LocalInvocationID.x;
    uvec2 tile = gl_WorkGroupID.xy;
    ivec2 at = ivec2(tile * 8u + uvec2(lane % 8u, lane / 8u));
    bool inside = all(lessThan(at, ivec2(p.size)));
    float z = inside ? texelFetch(view_z, at, 0).r : 0.0;
    if (lane == 0u) {
        nearest = 0xFFFFFFFFu;
        farthest = 0u;
        listed = 0u;
    }
    barrier();
    if (z > 0.0) {
        atomicMin(nearest, floatBitsToUint(z));
        atomicMax(farthest, floatBitsToUint(z));
    }
    barrier();
    TileBounds b;
    b.min_z = uintBitsToFloat(nearest);
    b.max_z = uintBitsToFloat(farthest);
    b.cells = 0u;
    b.reserved = 0u;
    TileVolume volume = volume_of_pixels(tile * 8u, tile * 8u + 8u, b);
    for (uint i = lane; i < p.locals; i += 64u) {
        vec2 depths;
        vec3 low, high;
        vec4 sphere = uintBitsToFloat(texelFetch(volumes, int(i)));
        if (farthest > 0u && sphere_touches(volume, sphere, depths, low, high)) {
            uint place = atomicAdd(listed, 1u);
            if (place < 1024u) list[place] = i;
        }
    }
    barrier();
    vec3 n = from_octahedral(texelFetch(normal, min(at, ivec2(p.size) - 1), 0).rg);
    vec3 q = vec3((vec2(at) - p.k.zw) / p.k.xy, 1.0) * z;
    vec3 sum = vec3(0.0);
    uint count = min(listed, 1024u);
    for (uint k = 0u; k < count; ++k) {
        uint i = p.first_local + list[k];
        vec4 place = uintBitsToFloat(texelFetch(lights, int(4u * i)));
        vec4 color = uintBitsToFloat(texelFetch(lights, int(4u * i + 1u)));
        vec3 way = place.xyz - q;
        float squared = max(dot(way, way), 1e-6);
        float ratio = squared / (color.w * color.w);
        float within = clamp(1.0 - ratio * ratio, 0.0, 1.0);
        sum += color.rgb * (max(dot(n, way) * inversesqrt(squared), 0.0) * within * within /
                            max(squared, 0.01));
    }
    if (inside) irradiance[uint(at.y) * p.size.x + uint(at.x)] = vec4(sum, 1.0);
}
