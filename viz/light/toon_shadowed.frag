#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_SHADOW_Z
#include "viz/light/toon.glsl"
