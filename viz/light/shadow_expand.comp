#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/light/shadow_shared.h"
// Each pixel takes the mask of its texel: both are in one tile, so slots mean the same lights.
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { ShadowParams p; };
layout(set = 0, binding = 0) uniform usamplerBuffer traced;  // word_quads
layout(scalar, set = 0, binding = 1) writeonly buffer Masks { uvec4 masks[]; };

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    if (at.x >= p.size.x) return;
    masks[at.y * p.size.x + at.x] = texelFetch(traced, int((at.y / 2u) * p.texels.x + at.x / 2u));
}
