#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/light/forward_head.glsl"

void main() {
    Surface s = mesh_seen();
    vec3 light = shade(s, list_at(gl_FragCoord.xy), 0u);
    float opacity = uintBitsToFloat(texelFetch(materials, int(3u * s.material + 2u)).w);
    float away = 1.0 - max(dot(s.normal, -normalize(s.place)), 0.0);
    float squared = away * away;
    float cover = opacity + (1.0 - opacity) * 0.96 * squared * squared * away;
    out_linear = vec4(light, cover);
}
