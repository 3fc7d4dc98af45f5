#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#ifndef KINO_KEY32
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "viz/surface/surface_shared.h"
#ifndef KINO_LOCAL_SIZE
#define KINO_LOCAL_SIZE 64
#endif
layout(local_size_x = KINO_LOCAL_SIZE) in;
layout(push_constant, scalar) uniform Push { SurfaceParams p; };
#include "viz/surface/depth_grid.glsl"
