// The thin surface every drawable ends in (docs/overview.md, the surface contract). Targets that
// nobody reads are not attached, and what is written to them vanishes.
layout(location = 0) out vec4 out_albedo;   // sRGB, straight from the camera; a: 1 covered
layout(location = 1) out float out_view_z;  // metres along the view axis, 0: nothing
layout(location = 2) out vec2 out_normal;   // octahedral, view space
layout(location = 3) out uint out_id;       // depth pixel (cloud) or triangle (mesh); ~0: nothing

// Colour of what the depth camera saw and the colour camera did not.
const vec3 kUncoloured = vec3(143.0, 145.0, 153.0) / 255.0;

vec3 background_at(float v) {
    vec3 top = unpackUnorm4x8(p.background.x).rgb;
    vec3 bottom = unpackUnorm4x8(p.background.y).rgb;
    return mix(top, bottom, v);
}
