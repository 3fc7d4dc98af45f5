// What a fragment shader of meshes begins with that walks light lists (viz/light/mesh_light.h).
// With KINO_SHADOW_Z it is also given the depths that the shadow masks were made of.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/light_shared.h"
#include "viz/surface/mesh_shared.h"
layout(push_constant, scalar) uniform Push {
    MeshView view;
    ListShadeParams p;
};
#define KINO_MESH_OWN_PUSH
#include "viz/surface/mesh_fragment.glsl"
layout(set = 0, binding = 5) uniform usamplerBuffer lights;
layout(set = 0, binding = 6) uniform usamplerBuffer headers;
layout(set = 0, binding = 7) uniform usamplerBuffer indices;
layout(set = 0, binding = 8) uniform usamplerBuffer shadow_masks;
layout(set = 0, binding = 9) uniform usamplerBuffer materials;
layout(set = 0, binding = 10) uniform usamplerBuffer lobes;
#ifdef KINO_SHADOW_Z
layout(set = 0, binding = 11) uniform sampler2D shadow_z;
#endif
layout(location = 0) out vec4 out_linear;
#define KINO_FIRST_LIGHT_CONSTANT 3
#include "viz/light/light_loop.glsl"
#include "viz/light/shade_surface.glsl"

Surface mesh_seen() {
    Surface s;
    s.base = mesh_base_color();
    s.normal = mesh_normal();
    s.place = mesh_position();
    s.material = mesh_material();
    return s;
}

// The pixel whose shadow mask is this fragment's. Masks are of pixel centres; a fragment that has
// only a pixel's rim is on another surface, and takes the mask of the neighbour in its tile whose
// depth is nearest to its own. (Slots of another tile are those of other lights.)
uint mask_pixel(float z) {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 found = at;
#ifdef KINO_SHADOW_Z
    uvec2 tile = uvec2((vec2(at) + 0.5) * p.tile_scale);
    ivec2 last = textureSize(shadow_z, 0) - 1;
    float off = abs(texelFetch(shadow_z, at, 0).r - z);
    for (int i = 0; i < 4; ++i) {
        ivec2 to = clamp(at + ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0),
                         ivec2(0), last);
        float there = abs(texelFetch(shadow_z, to, 0).r - z);
        // Half as far at most: a slope's own pixel stays its own.
        bool better = 2.0 * there < off &&
                      (kLists == 0u || uvec2((vec2(to) + 0.5) * p.tile_scale) == tile);
        found = better ? to : found;
        off = better ? there : off;
    }
#endif
    return uint(found.y) * p.row_px + uint(found.x);
}
