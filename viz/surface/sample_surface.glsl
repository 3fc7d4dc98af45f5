// The thin surface in two texels a sample. Whole numbers of 16 bits for object and normal, for
// pictures of integers need not have several samples; includes octahedral.glsl.
struct SurfaceSample {
    uint object;
    vec3 normal;  // unit, view space
    float view_z;
    vec4 albedo;  // sRGB; a: 1 covered, 0 background
};

vec4 packed_identity(uint object, vec2 octahedral) {
    // The same steps as 16 bits with a sign have.
    vec2 steps = round(clamp(octahedral, -1.0, 1.0) * 32767.0) + 32768.0;
    return vec4(float(object & 0xFFFFu), float(object >> 16), steps) / 65535.0;
}

// 24 bits of colour are whole numbers that a float holds; background is negative.
vec2 packed_place(float view_z, vec4 albedo) {
    vec3 bytes = round(clamp(albedo.rgb, 0.0, 1.0) * 255.0);
    float color = (bytes.r * 256.0 + bytes.g) * 256.0 + bytes.b;
    return vec2(view_z, albedo.a > 0.0 ? color : -1.0 - color);
}

uint sample_object(vec4 identity) {
    uvec2 halves = uvec2(round(identity.xy * 65535.0));
    return halves.y << 16 | halves.x;
}
vec3 sample_normal(vec4 identity) {
    return from_octahedral((round(identity.zw * 65535.0) - 32768.0) / 32767.0);
}
vec4 sample_albedo(vec2 place) {
    uint color = uint(place.y < 0.0 ? -1.0 - place.y : place.y);
    uvec3 bytes = uvec3(color >> 16, color >> 8, color) & 255u;
    return vec4(vec3(bytes) / 255.0, place.y < 0.0 ? 0.0 : 1.0);
}
