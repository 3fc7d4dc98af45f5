// Vertices made in the shader (programmable vertex pulling; Riccio and Lilley, GPU Pro 4). The
// code of a format is compiled only where its bit is set in kFormats: on a device that runs both
// sides of an `if`, every format compiled is paid for.
layout(constant_id = 0) const uint kFormats = 1u;
layout(constant_id = 1) const uint kCarrier = 0u;
layout(binding = 0) uniform usamplerBuffer draw_rows;
layout(binding = 1) uniform usamplerBuffer static_vertices;
layout(binding = 2) uniform usamplerBuffer skinned_vertices;
layout(binding = 3) uniform usamplerBuffer row_of_draw;
#include "viz/surface/octahedral.glsl"

struct PulledVertex {
    vec3 position;  // object space
    vec3 normal;
    vec2 uv;
    vec3 color;  // linear, times the material's
    bool known;  // false: a format this shader does not know, or a triangle to drop
};

uvec4 draw_texel(uint row, int part) { return texelFetch(draw_rows, int(row) * 8 + part); }

vec3 pulled_srgb(vec3 c) {
    return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045)));
}

// Two 16-bit depths a word, behind the two texels of the head.
float grid_depth(uint head, uvec2 at, uint width) {
    uint i = at.y * width + at.x;
    uint word = texelFetch(static_vertices, int(head + 2u + i / 8u))[(i / 2u) & 3u];
    return float((i & 1u) != 0u ? word >> 16 : word & 0xFFFFu);
}

// A corner cannot drop its triangle, so every corner looks at all three.
PulledVertex pull_grid(uint head, uint index) {
    uvec4 a = texelFetch(static_vertices, int(head));
    vec4 k = uintBitsToFloat(texelFetch(static_vertices, int(head) + 1));
    float unit = uintBitsToFloat(a.z);
    float edge = uintBitsToFloat(a.w);
    uint cell = index / 6u;
    uint corner = index - 6u * cell;
    uint cells_x = a.x - 1u;
    uvec2 at = uvec2(cell % cells_x, cell / cells_x);
    // (0, 0) (1, 0) (0, 1) and (1, 0) (1, 1) (0, 1).
    bool second = corner >= 3u;
    uvec2 p0 = at + (second ? uvec2(1, 0) : uvec2(0, 0));
    uvec2 p1 = at + (second ? uvec2(1, 1) : uvec2(1, 0));
    uvec2 p2 = at + uvec2(0, 1);
    vec3 z = unit * vec3(grid_depth(head, p0, a.x), grid_depth(head, p1, a.x),
                         grid_depth(head, p2, a.x));
    float low = min(z.x, min(z.y, z.z));
    float high = max(z.x, max(z.y, z.z));
    uint mine = second ? corner - 3u : corner;
    uvec2 pixel = mine == 0u ? p0 : (mine == 1u ? p1 : p2);
    vec3 ray = vec3((vec2(pixel) - k.zw) * k.xy, 1.0);
    // Depth is measured along the axis; y and z turn from camera axes to a mesh's own.
    return PulledVertex(ray * z[mine] * vec3(1.0, -1.0, -1.0),
                        -normalize(ray) * vec3(1.0, -1.0, -1.0), vec2(0.0), vec3(1.0),
                        low > 0.0 && high - low <= edge);
}

PulledVertex pull_vertex(uint id, uint static_first, uint index) {
    uint format = id >> KINO_FIRST_VERTEX_BITS;
    uint first = id & ((1u << KINO_FIRST_VERTEX_BITS) - 1u);
    uint at = first + index;
    PulledVertex v = PulledVertex(vec3(0.0), vec3(0.0), vec2(0.0), vec3(1.0), false);
    if ((kFormats & (1u << KINO_FORMAT_STATIC)) != 0u && format == KINO_FORMAT_STATIC) {
        vec4 a = uintBitsToFloat(texelFetch(static_vertices, int(at) * 2));
        vec4 b = uintBitsToFloat(texelFetch(static_vertices, int(at) * 2 + 1));
        v = PulledVertex(a.xyz, vec3(a.w, b.xy), b.zw, vec3(1.0), true);
    }
    if ((kFormats & (1u << KINO_FORMAT_SKINNED)) != 0u && format == KINO_FORMAT_SKINNED) {
        vec4 a = uintBitsToFloat(texelFetch(skinned_vertices, int(at) * 2));
        vec4 b = uintBitsToFloat(texelFetch(skinned_vertices, int(at) * 2 + 1));
        vec4 still =
            uintBitsToFloat(texelFetch(static_vertices, int(static_first + index) * 2 + 1));
        v = PulledVertex(a.xyz, vec3(a.w, b.xy), still.zw, vec3(1.0), true);
    }
    if ((kFormats & (1u << KINO_FORMAT_GRID)) != 0u && format == KINO_FORMAT_GRID) {
        v = pull_grid(first, index);
    }
    if ((kFormats & (1u << KINO_FORMAT_CLOUD)) != 0u && format == KINO_FORMAT_CLOUD) {
        uvec4 a = texelFetch(static_vertices, int(at));
        v = PulledVertex(uintBitsToFloat(a.xyz), vec3(0.0, 0.0, 1.0), vec2(0.0),
                         pulled_srgb(unpackUnorm4x8(a.w).rgb), true);
    }
    if ((kFormats & (1u << KINO_FORMAT_QUANTIZED)) != 0u && format == KINO_FORMAT_QUANTIZED) {
        uint word = at * 3u;
        uvec4 a = texelFetch(static_vertices, int(word / 4u));
        uvec4 b = texelFetch(static_vertices, int(word / 4u) + 1);
        uint shift = word & 3u;
        uint w0 = a[shift];
        uint w1 = shift < 3u ? a[shift + 1u] : b.x;
        uint w2 = shift < 2u ? a[shift + 2u] : b[shift - 2u];
        v = PulledVertex(vec3(unpackSnorm2x16(w0), unpackSnorm2x16(w1).x), unpack_octahedral(w2),
                         vec2(0.0), vec3(1.0), true);
    }
    return v;
}
