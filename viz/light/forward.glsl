#define KINO_MESH_INTERPOLATION centroid
#include "viz/light/forward_head.glsl"
// Opaque meshes with layered materials, shaded where they are drawn.
void main() {
    Surface s = mesh_seen();
    out_linear = vec4(shade(s, list_at(gl_FragCoord.xy), mask_pixel(s.place.z)), 1.0);
}
