// The guide words of viz/quality/lod_shared.h.
uint guide_word(float z, vec3 n, bool there) {
    vec2 slope = n.xy / max(-n.z, kGuideLeastTowards);
    uvec2 s = uvec2(clamp(round(slope * kGuideNormalSteps) + 128.0, 1.0, 255.0));
    float steps = (log2(z) - kGuideNearLog2) * kGuideStepsPerOctave;
    uint q = uint(clamp(round(steps), 0.0, kGuideMostSteps)) + 1u;
    return there ? q << 16 | s.y << 8 | s.x : 128u << 8 | 128u;
}

bool is_there(float z) { return z > 0.0 && z < 1e9; }
