#version 460
layout(push_constant) uniform Push { uvec2 tiles; float tile_px; float full; };
layout(set = 0, binding = 0) uniform usamplerBuffer headers;
layout(location = 0) out vec4 out_linear;

// Length of each pixel's list: none black, few blue, half of `full` green, `full` and more red (GPU
// Pro 4, Forward+, figure 5.7).
void main() {
    uvec2 tile = uvec2(gl_FragCoord.xy / tile_px);
    float heat = min(float(texelFetch(headers, int(tile.y * tiles.x + tile.x)).y) / full, 1.0);
    vec3 color = heat < 0.5 ? mix(vec3(0.0, 0.0, 1.0), vec3(0.0, 1.0, 0.0), heat * 2.0)
                            : mix(vec3(0.0, 1.0, 0.0), vec3(1.0, 0.0, 0.0), heat * 2.0 - 1.0);
    out_linear = vec4(heat > 0.0 ? color : vec3(0.0), 1.0);
}
