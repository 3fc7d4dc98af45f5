#version 460
#extension GL_GOOGLE_include_directive : require
#define KINO_SAMPLES
#include "viz/light/toon.glsl"
