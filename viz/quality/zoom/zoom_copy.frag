#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/zoom/zoom_shared.h"
layout(push_constant, scalar) uniform Push { ZoomParams p; };
layout(set = 0, binding = 0) uniform sampler2D small;
layout(location = 0) out vec4 out_color;
layout(constant_id = 0) const uint kBlur = 0;  // ZoomBlur

vec4 pixel(ivec2 at) {
    return texelFetch(small, clamp(at, ivec2(0), textureSize(small, 0) - 1), 0);
}

// Weights of the block's neighbours before, itself, and after at phase `at` of z.
vec3 spline(int at) {
    // The second box over the tent's weights; reach is half a block.
    float z = float(p.z);
    int reach = p.z / 2;
    vec3 sum = vec3(0.0);
    for (int k = -reach; k <= reach; ++k) {
        float share = (p.z % 2 == 0 && abs(k) == reach ? 0.5 : 1.0) / z;
        float off = (2.0 * float(at + k) + 1.0 - z) / (2.0 * z);  // blocks from the centre
        sum += share * max(vec3(0.0), 1.0 - abs(off - vec3(-1.0, 0.0, 1.0)));
    }
    return sum;
}

void main() {
    ivec2 at = clamp(ivec2(gl_FragCoord.xy) + p.offset, ivec2(0), textureSize(small, 0) * p.z - 1);
    if (kBlur == 0u) {
        out_color = texelFetch(small, at / p.z, 0);
    } else if (kBlur == 1u) {
        out_color = textureLod(small, (vec2(at) + 0.5) / vec2(textureSize(small, 0) * p.z), 0.0);
    } else {
        ivec2 block = at / p.z;
        vec3 wx = spline(at.x - block.x * p.z);
        vec3 wy = spline(at.y - block.y * p.z);
        vec4 sum = vec4(0.0);
        for (int y = 0; y < 3; ++y) {
            for (int x = 0; x < 3; ++x) {
                sum += wx[x] * wy[y] * pixel(block + ivec2(x, y) - 1);
            }
        }
        out_color = sum;
    }
}
