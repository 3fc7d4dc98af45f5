// Meshes into the thin surface. Attachments have no gaps: without ids (KINO_WITHOUT_ID) the object
// moves up.
#include "viz/surface/mesh_fragment.glsl"
layout(location = 0) out vec4 out_albedo;
layout(location = 1) out float out_view_z;
layout(location = 2) out vec2 out_normal;
#ifndef KINO_WITHOUT_ID
layout(location = 3) out uint out_id;
layout(location = 4) out uint out_object;
#else
layout(location = 3) out uint out_object;
#endif

void main() {
    out_albedo = vec4(mesh_albedo(), 1.0);
    out_view_z = mesh_position().z;
    out_normal = to_octahedral(mesh_normal());
#ifndef KINO_WITHOUT_ID
    out_id = uint(gl_PrimitiveID);
#endif
    out_object = mesh_object();
}
