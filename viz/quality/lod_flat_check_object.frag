#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#define KINO_LOD_OBJECT
#include "viz/quality/lod_flat_check.glsl"
