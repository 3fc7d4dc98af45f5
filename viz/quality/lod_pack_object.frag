#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_LOD_OBJECT
#include "viz/quality/lod_pack.glsl"
