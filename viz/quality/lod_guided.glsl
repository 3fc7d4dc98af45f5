// What the packed kernels that compare guides are given, and how they end.
#include "viz/quality/lod_shared.h"
#include "viz/surface/octahedral.glsl"
#include "viz/quality/lod_color.glsl"
#include "viz/quality/lod_guide.glsl"
#include "viz/quality/lod_up.glsl"
#include "viz/light/final_color.glsl"
layout(push_constant, scalar) uniform Push {
    LodParams p;
    FinalParams final_params;
};
#include "viz/quality/lod_constants.glsl"
#include "viz/quality/lod_eq1.glsl"
layout(set = 0, binding = 1) uniform sampler2D coarse_light;
layout(set = 0, binding = 2) uniform usampler2D coarse_guide;
layout(set = 0, binding = 3) uniform sampler2D albedo;
layout(set = 0, binding = 4) uniform sampler2D view_z;
layout(set = 0, binding = 5) uniform sampler2D normal;
#ifdef KINO_LOD_OBJECT
#include "viz/quality/lod_object.glsl"
layout(set = 0, binding = 6) uniform usampler2D object;
#endif

FineGuide fine_guide(ivec2 here) {
    return packed_fine_guide(vec2(here), texelFetch(view_z, here, 0).r,
                             from_octahedral(texelFetch(normal, here, 0).rg));
}

float fine_tag(ivec2 here) {
#ifdef KINO_LOD_OBJECT
    return object_tag(texelFetch(object, here, 0).r);
#else
    return 0.0;
#endif
}
