#ifndef KINO_VIZ_SURFACE_MESH_SHARED_H
#define KINO_VIZ_SURFACE_MESH_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// One draw of a table: where its vertices lie, how they get into view space and what they look
// like. 128 bytes, read as eight texels of four words.
struct MeshDraw {
    vec4 view_from_object_x;  // rows: view = row.xyz * p + row.w; made in double
    vec4 view_from_object_y;
    vec4 view_from_object_z;
    vec3 normal_x;  // rows of the inverse transpose, up to a positive factor
    uint object;    // material << 16 | object id
    vec3 normal_y;
    uint color_rg;  // linear base colour as half floats
    vec3 normal_z;
    uint color_b_texture;  // its blue; high half: texture + 1 in 15 bits, top bit: mirrored
    vec3 sphere_center;    // view space, metres
    float sphere_radius_m;
    uint id;            // vertex format << KINO_FIRST_VERTEX_BITS | first vertex
    uint static_first;  // skinned: first vertex of the part that does not move
    uint first_index;
    uint index_count;
};

// The view, 32 bytes at the front of every mesh pass's push constants; a forward pass's own follow.
struct MeshView {
    vec4 k;        // fx, fy, cx, cy of the view, px, pixel centres at integers
    uvec2 target;  // picture size, px
    float near_m;
    uint first_row;  // row of the table that draw 0 has
};

// Planes through the camera, normals inward, and the near plane.
struct MeshCull {
    vec4 side[4];  // xyz: unit normal in view space
    float near_m;
    uint draws;
    uint capacity;
    uint mode;  // KINO_CULL_*
};

// One skinned mesh of a frame.
struct MeshSkin {
    uint vertices;
    uint source_first;  // vertex of the static pool: the bind pose
    uint target_first;  // vertex of the skinned pool
    uint weights_first;
    uint joints_first;  // row of the frame's joints; KINO_SKIN_*_ROWS each
    uint joints;
    uint blend;  // KINO_SKIN_*
};

// What the culling pass counts.
struct MeshCounters {
    uint drawn;     // what the count buffer holds: never more than the capacity
    uint culled;    // provably outside
    uint refused;   // not finite, or a negative radius
    uint overflow;  // visible beyond the capacity
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::MeshDraw) == 128);
static_assert(sizeof(kino::shared::MeshView) == 32);
static_assert(sizeof(kino::shared::MeshCull) == 80);
#endif
// Vertex formats, one bit each in the fetch shader's constant 0.
#define KINO_FORMAT_STATIC 0u     // position, normal, uv: 32 bytes
#define KINO_FORMAT_SKINNED 1u    // position, normal anew each frame: 32; uv from the static part
#define KINO_FORMAT_GRID 2u       // nothing but the depth image
#define KINO_FORMAT_CLOUD 3u      // position, RGBA8: 16 bytes
#define KINO_FORMAT_QUANTIZED 4u  // position in snorm16 of its box, octahedral normal: 12 bytes
#define KINO_FORMATS 5u
#define KINO_FORMAT_BITS 5u
#define KINO_FIRST_VERTEX_BITS 27u
// How a draw says which row of the table it is: constant 1.
#define KINO_CARRIER_FIRST_INSTANCE 0u
#define KINO_CARRIER_DRAW_ID 1u
#define KINO_CARRIER_ATTRIBUTE 2u
#define KINO_CARRIER_INSTANCE 3u
#define KINO_CARRIER_PUSHED 4u
// Culled draws stay with no instance, or the others move up in order.
#define KINO_CULL_ZERO_INSTANCE 0u
#define KINO_CULL_COMPACT 1u
// How vertices follow their joints, and how many rows a joint has: three of its matrix, then the
// quaternion (x, y, z, w) of its rotation.
#define KINO_SKIN_LINEAR 0u
#define KINO_SKIN_DUAL 1u
#define KINO_SKIN_LINEAR_ROWS 3u
#define KINO_SKIN_DUAL_ROWS 4u
// Draws that one lane of the ordered compaction takes.
#define KINO_CULL_RUN 32u
#endif
