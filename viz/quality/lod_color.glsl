// The sRGB transfer function (IEC 61966-2-1), to linear.
vec3 from_srgb(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

// What a broken shader wrote must not reach the neighbours: 0 times infinity is no number.
vec3 finite_light(vec3 c) {
    return mix(clamp(c, 0.0, 65000.0), vec3(0.0), isnan(c));
}

// Three 9-bit numbers with one exponent (as VK_FORMAT_E5B9G9R9_UFLOAT_PACK32).
uint pack_light(vec3 c) {
    float most = max(max(c.r, c.g), max(c.b, 1e-9));
    int e = clamp((floatBitsToInt(most) >> 23) - 127 + 16, 0, 31);
    float scale = intBitsToFloat((24 - e + 127) << 23);
    // Rounding up may need a tenth bit.
    if (round(most * scale) > 511.0) {
        e = min(e + 1, 31);
        scale = intBitsToFloat((24 - e + 127) << 23);
    }
    uvec3 m = uvec3(min(round(c * scale), vec3(511.0)));
    return uint(e) << 27 | m.b << 18 | m.g << 9 | m.r;
}

vec3 unpack_light(uint w) {
    float scale = uintBitsToFloat(((w >> 27) + 103u) << 23);
    return vec3(w & 511u, (w >> 9) & 511u, (w >> 18) & 511u) * scale;
}
