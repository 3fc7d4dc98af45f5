#version 460
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
layout(location = 0) out vec4 out_linear;
#define KINO_FIRST_LIGHT_CONSTANT 3
#include "viz/light/light_loop.glsl"
#include "viz/light/shade_surface.glsl"

void main() {
    Surface s;
    s.base = mesh_base_color();
    s.normal = mesh_normal();
    s.place = mesh_position();
    s.material = mesh_material();
    vec3 light = shade(s, list_at(gl_FragCoord.xy), 0u);
    float opacity = uintBitsToFloat(texelFetch(materials, int(3u * s.material + 2u)).w);
    float away = 1.0 - max(dot(s.normal, -normalize(s.place)), 0.0);
    float squared = away * away;
    float cover = opacity + (1.0 - opacity) * 0.96 * squared * squared * away;
    out_linear = vec4(light, cover);
}
