// Light that is worked out in parts which are added up. Bit 0: what lights give and nothing else.
// Bit 1: this picture is added to one that has the pixels which show nothing.
layout(constant_id = KINO_FIRST_LIGHT_CONSTANT + 8) const uint kPart = 0u;

vec3 own_light(vec3 light) { return (kPart & 1u) != 0u ? vec3(0.0) : light; }

// What is added counts by its alpha.
vec4 part_of_pixel(vec3 light, vec3 nothing, float alpha) {
    bool adds = (kPart & 2u) != 0u;
    bool there = alpha > 0.0;
    return vec4(there ? light : nothing, adds ? (there ? 1.0 : 0.0) : alpha);
}
