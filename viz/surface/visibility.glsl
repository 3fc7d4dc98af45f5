// The visibility buffer: for every pixel {index, depth bits}, the nearest wins. With 64-bit
// atomics that is one atomicMin on (depth << 32 | index). Without, the same bits come about in
// two passes over the same geometry: first the least depth, then the least index that has it.
#ifdef KINO_KEY32
layout(scalar, set = 0, binding = 0) buffer Visibility { uint words[]; } visibility;

void put(uint pixel, float z, uint index, uint key_pass) {
    uint bits = floatBitsToUint(z);
    if (key_pass == 0u) {
        atomicMin(visibility.words[2u * pixel + 1u], bits);
    } else if (visibility.words[2u * pixel + 1u] == bits) {
        atomicMin(visibility.words[2u * pixel], index);
    }
}
#else
layout(scalar, set = 0, binding = 0) buffer Visibility { uint64_t keys[]; } visibility;

void put(uint pixel, float z, uint index, uint key_pass) {
    atomicMin(visibility.keys[pixel], (uint64_t(floatBitsToUint(z)) << 32) | uint64_t(index));
}
#endif
