#include "viz/quality/lod_guided.glsl"

// Eq. 1 at every pixel.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Eq1 found = equation_one(fine_guide(here), fine_tag(here), coarse_light, coarse_guide);
    put(found.light, texelFetch(albedo, here, 0), found.e, found.f);
}
