#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_ID_ATTRIBUTE
#include "viz/surface/mesh_pull.glsl"
