#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/surface_shared.h"
layout(push_constant, scalar) uniform Push { SurfaceParams p; };
layout(constant_id = 0) const uint kWantNormal = 0u;
layout(constant_id = 1) const uint kHasColor = 1u;
#include "viz/surface/visibility_inputs.glsl"
#include "viz/surface/depth_inputs.glsl"
layout(scalar, set = 0, binding = 4) readonly buffer Normals { uint normals[]; };
#include "viz/surface/depth_grid.glsl"
#include "viz/surface/octahedral.glsl"
#include "viz/surface/surface_out.glsl"
