#include "viz/surface/surface_shared.h"
layout(push_constant, scalar) uniform Push { SurfaceParams p; };
#include "viz/surface/visibility_inputs.glsl"
#include "viz/surface/surface_out.glsl"
#include "viz/surface/fill_holes.glsl"

// The keys already hold colours (viz/surface/payload.glsl): nothing to look up.
void main() {
    uvec2 hit = nearest_or_filled(uvec2(gl_FragCoord.xy));
    bool covered = hit.y != KINO_EMPTY;
    out_albedo = covered ? vec4(unpackUnorm4x8(hit.x).rgb, 1.0)
                         : vec4(background_at(gl_FragCoord.y / float(p.target.y)), 0.0);
    out_view_z = covered ? uintBitsToFloat(hit.y) : 0.0;
    out_normal = vec2(0.0);
    out_id = KINO_EMPTY;
}
