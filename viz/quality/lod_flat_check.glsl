#include "viz/quality/lod_guided.glsl"

// A flat tile whose pixels may show what no coarse pixel saw: light as lod_flat.frag makes it, and
// the doubt by one coarse pixel, as all are of one surface.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Footprint at = footprint_of(vec2(here), p.coarse_of_fine, p.last);
    ivec2 nearest = ivec2(at.t.x < 0.5 ? at.a.x : at.b.x, at.t.y < 0.5 ? at.a.y : at.b.y);
    uint guide = texelFetch(coarse_guide, nearest, 0).r;
    // All four have one object, or the tile were not flat.
    float tag = texelFetch(coarse_light, at.a, 0).a;
    CoarseGuides j = unpacked_guides(uvec4(guide), vec4(nearest.x), vec4(nearest.y), vec4(tag),
                                     fine_tag(here));
    put(tent_light(coarse_light, at), texelFetch(albedo, here, 0),
        eq1_exponents(fine_guide(here), j).x);
}
