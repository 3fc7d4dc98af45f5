// Unit vectors in two numbers (Cigolle et al. 2014, "A Survey of Efficient Representations for
// Independent Unit Vectors").
vec2 to_octahedral(vec3 n) {
    vec2 o = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 folded = (1.0 - abs(o.yx)) * vec2(o.x >= 0.0 ? 1.0 : -1.0, o.y >= 0.0 ? 1.0 : -1.0);
    return n.z < 0.0 ? folded : o;
}

vec3 from_octahedral(vec2 o) {
    vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
    float fold = max(-n.z, 0.0);
    n.x += n.x >= 0.0 ? -fold : fold;
    n.y += n.y >= 0.0 ? -fold : fold;
    return normalize(n);
}

uint pack_octahedral(vec3 n) { return packSnorm2x16(to_octahedral(n)); }
vec3 unpack_octahedral(uint bits) { return from_octahedral(unpackSnorm2x16(bits)); }
