#include "viz/quality/lod_guided.glsl"

// Eq. 1 at every pixel.
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    FineGuide i = fine_guide(here);
    float tag = fine_tag(here);
    Eq1 found = kKernel == 0u ? equation_one(i, tag, coarse_light, coarse_guide)
                              : equation_one_4x4(i, tag, coarse_light, coarse_guide);
    put(found.light, texelFetch(albedo, here, 0), found.bits);
}
