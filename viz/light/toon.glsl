#define KINO_MESH_INTERPOLATION centroid
#include "viz/light/forward_head.glsl"
// Paint: light counts in steps, and outlines are dark. A whole picture's worth of lights must be
// summed before it can be cut into steps, so no sum of lobes does this.
void main() {
    Surface s = mesh_seen();
    TileList list = list_at(gl_FragCoord.xy);
#ifdef KINO_SAMPLES
    if (cover_of(s).hidden) list.count = 0u;
#endif
    uint pixel = mask_pixel(s.place.z);
    vec3 arriving = p.ambient;
    vec3 l;
    if (kGlobals != 0u) {
        for (uint i = 0u; i < p.globals; ++i) {
            vec3 light = global_light(i, l) * unmasked(i, i, s.material, pixel);
            arriving += light * max(dot(s.normal, l), 0.0);
        }
    }
    for (uint j = 0u; j < list.count; ++j) {
        uint i = light_in(list, j);
        vec3 light = local_light(i, s.place, l) * unmasked(i, p.globals + j, s.material, pixel);
        arriving += light * max(dot(s.normal, l), 0.0);
    }
    uvec4 m0 = texelFetch(materials, int(3u * s.material));
    float steps = float(m0.w);
    float bright = dot(arriving, vec3(0.2126, 0.7152, 0.0722));
    // To the nearest step; between steps it climbs within a tenth, so that it does not flicker.
    float t = bright * steps;
    float whole = floor(t);
    float stepped = (whole + smoothstep(0.45, 0.55, t - whole)) / steps;
    vec3 light = arriving * (stepped / max(bright, 1e-6));
    float facing = dot(s.normal, -normalize(s.place));
    float outline = smoothstep(0.15, 0.25, facing);
    vec3 emitted = uintBitsToFloat(texelFetch(materials, int(3u * s.material + 1u)).xyz);
    out_linear = vec4(s.base * light * outline + emitted, 1.0);
}
