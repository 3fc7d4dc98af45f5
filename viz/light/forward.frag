#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_SAMPLES
#define KINO_MESH_INTERPOLATION centroid
#include "viz/light/forward_head.glsl"

// Opaque meshes with layered materials: pixels that one triangle has whole are shaded already,
// those at edges are shaded here for each triangle that has a part of them.
void main() {
    Surface s = mesh_seen();
    Cover cover = cover_of(s);
    TileList list = list_at(gl_FragCoord.xy);
    if (cover.hidden || cover.whole) list.count = 0u;
    vec3 light = shade(s, list, mask_pixel(s.place.z));
    if (cover.whole) light = texelFetch(pixel_light, ivec2(gl_FragCoord.xy), 0).rgb;
    out_linear = vec4(light, 1.0);
}
