#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_KEY32
#include "viz/surface/mesh_cells.glsl"
