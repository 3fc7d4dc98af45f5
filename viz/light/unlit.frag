#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_MESH_INTERPOLATION centroid
#include "viz/light/forward_head.glsl"

// The base colour as it is, whatever shines on it: signs, screens, drawings.
void main() {
    vec3 emitted = uintBitsToFloat(texelFetch(materials, int(3u * mesh_material() + 1u)).xyz);
    out_linear = vec4(mesh_base_color() + emitted, 1.0);
}
