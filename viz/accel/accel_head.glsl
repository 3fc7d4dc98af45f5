// What all shaders of the build begin with.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/accel/accel_shared.h"
layout(push_constant, scalar) uniform Push { BuildParams p; };

struct SoupTriangle { vec3 a; vec3 b; vec3 c; };

uint invocation() {
    return gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x + gl_GlobalInvocationID.x;
}

vec3 centroid_of(SoupTriangle t) {
    precise vec3 sum = t.a + t.b + t.c;
    precise vec3 middle = sum * (1.0 / 3.0);
    return middle;
}

// Floats in the order of unsigned numbers, and back.
uint key_of(float value) {
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float value_of(uint key) {
    return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7FFFFFFFu : ~key);
}

const uint kLeafBit = 4u;
