#version 460
#extension GL_GOOGLE_include_directive : require
#include "viz/surface/mesh_pull.glsl"
