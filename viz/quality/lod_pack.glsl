#include "viz/quality/lod_color.glsl"
layout(constant_id = 0) const uint kFineGrained = 1;
layout(set = 0, binding = 0) uniform sampler2D coarse_linear;
layout(set = 0, binding = 1) uniform sampler2D coarse_albedo;
#ifdef KINO_LOD_OBJECT
#include "viz/quality/lod_object.glsl"
layout(set = 0, binding = 2) uniform usampler2D coarse_object;
#endif
layout(location = 0) out vec4 out_light;

// The coarse picture, finite, beside a number for its object; fine-grained: without its albedo, which is never zero.
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 light = finite_light(texelFetch(coarse_linear, at, 0).rgb);
    if (kFineGrained != 0u) {
        light /= max(from_srgb(texelFetch(coarse_albedo, at, 0).rgb), 1e-3);
    }
    out_light = vec4(min(light, 65000.0), 1.0);
#ifdef KINO_LOD_OBJECT
    out_light.a = object_tag(texelFetch(coarse_object, at, 0).r);
#endif
}
