// What every vertex shader of meshes hands on, in one place, so that positions are the same bits
// whichever way a vertex came in.
#include "viz/surface/mesh_color.glsl"
#include "viz/surface/mesh_shared.h"
layout(push_constant, scalar) uniform Push { MeshView view; };
layout(location = 0) out vec3 v_position;    // view space, metres
layout(location = 1) out vec3 v_normal;      // view space, unit at the corners
layout(location = 2) out vec2 v_uv;
layout(location = 3) flat out uvec4 v_draw;  // object, colour rg, colour b + texture, sRGB
invariant gl_Position;

// A draw's base colour, linear, as 8 bits of sRGB: once a vertex instead of once a pixel.
uint packed_srgb(vec3 base) { return packUnorm4x8(vec4(mesh_to_srgb(base), 1.0)); }

void place_vertex(vec3 position, vec3 normal, vec2 uv, uvec4 x, uvec4 y, uvec4 z, uvec4 nx,
                  uvec4 ny, uvec4 nz) {
    vec4 rx = uintBitsToFloat(x);
    vec4 ry = uintBitsToFloat(y);
    vec4 rz = uintBitsToFloat(z);
    precise vec3 p;
    p.x = rx.x * position.x + rx.y * position.y + rx.z * position.z + rx.w;
    p.y = ry.x * position.x + ry.y * position.y + ry.z * position.z + ry.w;
    p.z = rz.x * position.x + rz.y * position.y + rz.z * position.z + rz.w;
    v_position = p;
    vec3 n = vec3(dot(uintBitsToFloat(nx.xyz), normal), dot(uintBitsToFloat(ny.xyz), normal),
                  dot(uintBitsToFloat(nz.xyz), normal));
    // Stretching must not give one corner of a triangle more say than the others.
    float squared = dot(n, n);
    v_normal = squared > 0.0 ? n * inversesqrt(squared) : normal;
    v_uv = uv;
    v_draw = uvec4(nx.w, ny.w, nz.w,
                   packed_srgb(vec3(unpackHalf2x16(ny.w), unpackHalf2x16(nz.w).x)));
    // Reversed depth without a far plane: near -> 1, infinity -> 0.
    vec2 size = vec2(view.target);
    precise vec4 clip;
    clip.xy = 2.0 * (view.k.xy * p.xy + (view.k.zw + 0.5) * p.z) / size - p.z;
    clip.z = view.near_m;
    clip.w = p.z;
    gl_Position = clip;
}
