// Vertices made in the shader (programmable vertex pulling; Riccio and Lilley, GPU Pro 4). The
// code of a format is compiled only where its bit is set in kFormats: on a device that runs both
// sides of an `if`, every format compiled is paid for.
layout(constant_id = 0) const uint kFormats = 1u;
layout(constant_id = 1) const uint kCarrier = 0u;
layout(binding = 0) uniform usamplerBuffer draw_rows;
layout(binding = 1) uniform usamplerBuffer static_vertices;
layout(binding = 2) uniform usamplerBuffer skinned_vertices;
layout(binding = 3) uniform usamplerBuffer row_of_draw;

struct PulledVertex {
    vec3 position;  // object space
    vec3 normal;
    vec2 uv;
    bool known;  // false: a format this shader does not know
};

uvec4 draw_texel(uint row, int part) { return texelFetch(draw_rows, int(row) * 8 + part); }

PulledVertex pull_vertex(uint id, uint static_first, uint index) {
    uint format = id >> KINO_FIRST_VERTEX_BITS;
    uint at = (id & ((1u << KINO_FIRST_VERTEX_BITS) - 1u)) + index;
    PulledVertex v = PulledVertex(vec3(0.0), vec3(0.0), vec2(0.0), false);
    if ((kFormats & (1u << KINO_FORMAT_STATIC)) != 0u && format == KINO_FORMAT_STATIC) {
        vec4 a = uintBitsToFloat(texelFetch(static_vertices, int(at) * 2));
        vec4 b = uintBitsToFloat(texelFetch(static_vertices, int(at) * 2 + 1));
        v = PulledVertex(a.xyz, vec3(a.w, b.xy), b.zw, true);
    }
    if ((kFormats & (1u << KINO_FORMAT_SKINNED)) != 0u && format == KINO_FORMAT_SKINNED) {
        vec4 a = uintBitsToFloat(texelFetch(skinned_vertices, int(at) * 2));
        vec4 b = uintBitsToFloat(texelFetch(skinned_vertices, int(at) * 2 + 1));
        vec4 still =
            uintBitsToFloat(texelFetch(static_vertices, int(static_first + index) * 2 + 1));
        v = PulledVertex(a.xyz, vec3(a.w, b.xy), still.zw, true);
    }
    return v;
}
