#extension GL_EXT_scalar_block_layout : require
#extension GL_ARB_shader_draw_parameters : require
#include "viz/surface/mesh_vertex.glsl"
#include "viz/surface/mesh_fetch.glsl"
#ifdef KINO_ID_ATTRIBUTE
layout(location = 0) in uint a_row;
#endif

uint row_of_this_draw() {
#ifdef KINO_ID_ATTRIBUTE
    return a_row;
#else
    if (kCarrier == KINO_CARRIER_DRAW_ID) {
        return texelFetch(row_of_draw, int(view.first_row) + gl_DrawIDARB).x;
    }
    // One draw of many instances; everywhere else gl_InstanceIndex would add the instance to the id.
    if (kCarrier == KINO_CARRIER_INSTANCE) return uint(gl_InstanceIndex);
    if (kCarrier == KINO_CARRIER_PUSHED) return view.first_row;
    return uint(gl_BaseInstanceARB);
#endif
}

void main() {
    uint row = row_of_this_draw();
    uvec4 head = draw_texel(row, 7);
    PulledVertex v = pull_vertex(head.x, head.y, uint(gl_VertexIndex));
    place_vertex(v.position, v.normal, v.uv, draw_texel(row, 0), draw_texel(row, 1),
                 draw_texel(row, 2), draw_texel(row, 3), draw_texel(row, 4), draw_texel(row, 5));
    if ((kFormats & (1u << KINO_FORMAT_CLOUD)) != 0u) {
        vec3 base = vec3(unpackHalf2x16(v_draw.y), unpackHalf2x16(v_draw.z).x) * v.color;
        v_draw.w = packed_srgb(base);
        v_draw.y = packHalf2x16(base.xy);
        v_draw.z = (v_draw.z & 0xFFFF0000u) | packHalf2x16(vec2(base.z, 0.0));
    }
    // Outside of the clip volume, all corners of the triangle alike.
    if (!v.known) gl_Position = vec4(0.0, 0.0, 0.0, -1.0);
}
