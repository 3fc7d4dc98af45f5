// What a fragment shader of meshes can ask for; included after the version and extension lines by
// every such shader, also those of other rooms (MeshDrawer::record). A shader with push constants
// of its own includes viz/surface/mesh_shared.h, declares
//     layout(push_constant, scalar) uniform Push { MeshView view; Own own; };
// and does so before this file, with KINO_MESH_OWN_PUSH defined.
#include "viz/surface/mesh_shared.h"
#include "viz/surface/mesh_color.glsl"
#include "viz/surface/octahedral.glsl"
#ifndef KINO_MESH_OWN_PUSH
layout(push_constant, scalar) uniform Push { MeshView view; };
#endif
layout(constant_id = 2) const uint kTextures = 0u;
layout(binding = 4) uniform usamplerBuffer mesh_texels;
#ifndef KINO_MESH_INTERPOLATION
#define KINO_MESH_INTERPOLATION  // `centroid` where a pixel has several samples
#endif
layout(location = 0) KINO_MESH_INTERPOLATION in vec3 v_position;
layout(location = 1) KINO_MESH_INTERPOLATION in vec3 v_normal;
layout(location = 2) KINO_MESH_INTERPOLATION in vec2 v_uv;
layout(location = 3) flat in uvec4 v_draw;

vec4 mesh_texel(int first, ivec2 at, ivec2 size) {
    return unpackUnorm4x8(texelFetch(mesh_texels, first + at.y * size.x + at.x).x);
}

// sRGB-coded colour of texture `number` (from 1), bilinear between coded values as captured
// colours are, from the level whose texels are as large as pixels. Repeats.
vec3 mesh_texture(uint number, vec2 uv) {
    int head = (int(number) - 1) * 16;
    ivec2 full = ivec2(texelFetch(mesh_texels, head).x, texelFetch(mesh_texels, head + 1).x);
    int levels = int(texelFetch(mesh_texels, head + 2).x);
    vec2 dx = dFdx(uv) * vec2(full);
    vec2 dy = dFdy(uv) * vec2(full);
    float texels = max(dot(dx, dx), dot(dy, dy));
    int level = clamp(int(0.5 * log2(max(texels, 1e-12)) + 0.5), 0, levels - 1);
    ivec2 size = max(full >> level, ivec2(1));
    int first = int(texelFetch(mesh_texels, head + 4 + level).x);
    vec2 at = fract(uv) * vec2(size) - 0.5;
    vec2 low = floor(at);
    vec2 t = at - low;
    // fract() keeps `low` in -1 .. size - 1.
    ivec2 a = ivec2(low) + ivec2(lessThan(low, vec2(0.0))) * size;
    ivec2 b = ivec2(low) + 1;
    b -= ivec2(greaterThanEqual(b, size)) * size;
    vec3 top = mix(mesh_texel(first, a, size).rgb, mesh_texel(first, ivec2(b.x, a.y), size).rgb,
                   t.x);
    vec3 bottom =
        mix(mesh_texel(first, ivec2(a.x, b.y), size).rgb, mesh_texel(first, b, size).rgb, t.x);
    return mix(top, bottom, t.y);
}

// Linear: the material's base colour times its texture.
vec3 mesh_base_color() {
    vec3 color = vec3(unpackHalf2x16(v_draw.y), unpackHalf2x16(v_draw.z).x);
    uint number = (v_draw.z >> 16) & 0x7FFFu;
    if (kTextures != 0u) {
        vec3 coded = mesh_texture(max(number, 1u), v_uv);
        color *= number != 0u ? mesh_to_linear(coded) : vec3(1.0);
    }
    return color;
}

// The same as an 8-bit picture has it; where nothing is textured, from the vertex shader.
vec3 mesh_albedo() {
    return kTextures != 0u ? mesh_to_srgb(mesh_base_color()) : unpackUnorm4x8(v_draw.w).rgb;
}

// Unit, view space, of the side that is seen.
vec3 mesh_normal() {
    bool mirrored = (v_draw.z >> 31) != 0u;
    float side = gl_FrontFacing != mirrored ? 1.0 : -1.0;
    float squared = dot(v_normal, v_normal);
    return squared > 0.0 ? side * v_normal * inversesqrt(squared) : vec3(0.0, 0.0, -1.0);
}

vec3 mesh_position() { return v_position; }  // view space, metres
uint mesh_material() { return v_draw.x >> 16; }
uint mesh_object() { return v_draw.x; }  // material << 16 | object id
