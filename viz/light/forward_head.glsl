// What a fragment shader of meshes begins with that walks light lists (viz/light/mesh_light.h).
// With KINO_SAMPLES pixels have four samples, and it is also given their depths, 2 x 2 for a pixel,
// the depths of the pixels' centres, and what is seen there, shaded.
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
#ifdef KINO_SAMPLES
layout(set = 0, binding = 11) uniform sampler2D sample_z;
layout(set = 0, binding = 12) uniform sampler2D pixel_z;
layout(set = 0, binding = 13) uniform sampler2D pixel_light;
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

#ifdef KINO_SAMPLES
// What of its pixel a fragment has. Devices may shade fragments that the depth test throws away, and
// lanes that no fragment is in, so both are found out before any light is looked at.
struct Cover {
    bool hidden;  // no sample that it covers shows it
    bool whole;   // all samples and the centre do: what was shaded there is its light
};
Cover cover_of(Surface s) {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 z = vec4(texelFetch(sample_z, 2 * at, 0).r, texelFetch(sample_z, 2 * at + ivec2(1, 0), 0).r,
                  texelFetch(sample_z, 2 * at + ivec2(0, 1), 0).r,
                  texelFetch(sample_z, 2 * at + ivec2(1, 1), 0).r);
    bvec4 covered = notEqual(ivec4(gl_SampleMaskIn[0]) & ivec4(1, 2, 4, 8), ivec4(0));
    // Depth is another at the samples than here.
    float slope = fwidth(s.place.z) + 1e-5 * s.place.z;
    bvec4 near = lessThanEqual(abs(z - s.place.z), vec4(slope));
    float seen = dot(vec4(covered), vec4(near));
    return Cover(seen == 0.0, seen == 4.0 && abs(texelFetch(pixel_z, at, 0).r - s.place.z) <= slope);
}
#endif

// The pixel whose shadow mask is this fragment's. Masks are of pixel centres; a fragment that has
// only a pixel's rim is on another surface, and takes the mask of the neighbour in its tile whose
// depth is nearest to its own. (Slots of another tile are those of other lights.)
uint mask_pixel(float z) {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 found = at;
#ifdef KINO_SAMPLES
    if (kShadows == 0u) return 0u;
    uvec2 tile = uvec2((vec2(at) + 0.5) * p.tile_scale);
    ivec2 last = textureSize(pixel_z, 0) - 1;
    float off = abs(texelFetch(pixel_z, at, 0).r - z);
    for (int i = 0; i < 4; ++i) {
        ivec2 to = clamp(at + ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0),
                         ivec2(0), last);
        float there = abs(texelFetch(pixel_z, to, 0).r - z);
        // Half as far at most: a slope's own pixel stays its own.
        bool better = 2.0 * there < off &&
                      (kLists == 0u || uvec2((vec2(to) + 0.5) * p.tile_scale) == tile);
        found = better ? to : found;
        off = better ? there : off;
    }
#endif
    return uint(found.y) * p.row_px + uint(found.x);
}
