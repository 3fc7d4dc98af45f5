// What wins a pixel beside its depth. Where only the colour is wanted, the winner's colour itself
// travels in the key's low word: the resolve then reads one number a pixel instead of looking up
// the winner's corners. Where normals or ids are wanted, the low word is the index.
layout(constant_id = 0) const uint kColorPayload = 0u;

// Colour of what the depth camera saw and the colour camera did not, RGBA8.
const uint kUncolouredBits = 0xFF99918Fu;

uint opaque(uint rgba) { return (rgba >> 24) != 0u ? rgba | 0xFF000000u : kUncolouredBits; }

// Weighted colour of a triangle's corners, opaque colours, weights summing to 1. Two channels at a
// time in integers of eight fractional bits: within 1/255 of exact, at a third of the price.
uint mix_colors(uint a, uint b, uint c, vec2 weights_bc) {
    uint wb = uint(clamp(weights_bc.x, 0.0, 1.0) * 256.0 + 0.5);
    uint wc = min(uint(clamp(weights_bc.y, 0.0, 1.0) * 256.0 + 0.5), 256u - wb);
    uint wa = 256u - wb - wc;
    const uint kEven = 0x00FF00FFu;
    uint even = (a & kEven) * wa + (b & kEven) * wb + (c & kEven) * wc + 0x00800080u;
    uint odd = ((a >> 8) & kEven) * wa + ((b >> 8) & kEven) * wb + ((c >> 8) & kEven) * wc +
               0x00800080u;
    return ((even >> 8) & kEven) | (odd & ~kEven);
}

// A corner without colour takes a neighbour's, so that it does not darken those that have one.
uint color_or(uint own, uint other, uint another) {
    return (own >> 24) != 0u ? own : (other >> 24) != 0u ? other : opaque(another);
}
