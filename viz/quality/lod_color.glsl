// The sRGB transfer function (IEC 61966-2-1), to linear. Its power is a polynomial here, within
// 0.04 % (weighted least squares of the relative error): three powers a pixel cost more than the
// whole filter.
vec3 from_srgb(vec3 c) {
    vec3 power = ((((0.116574 * c - 0.368944) * c + 0.710382) * c + 0.507545) * c + 0.0339238) * c +
                 0.000883243;
    return mix(c / 12.92, power, greaterThan(c, vec3(0.04045)));
}

// What a broken shader wrote must not reach the neighbours: 0 times infinity is no number.
vec3 finite_light(vec3 c) {
    return mix(clamp(c, 0.0, 65000.0), vec3(0.0), isnan(c));
}
