layout(constant_id = 0) const uint kFineGrained = 1;
layout(constant_id = 1) const uint kKeepBackground = 1;
layout(constant_id = 2) const uint kMetric = 2;  // RangeMetric
layout(constant_id = 3) const uint kDoubt = 0u;
layout(constant_id = 4) const uint kKernel = 0;  // LodKernel
layout(constant_id = 5) const uint kFinal = 0;  // 1: the picture is finished on the way
layout(location = 0) out vec4 out_color;
layout(location = 1) out float out_doubt;

void put_linear(vec4 c) {
    out_color = kFinal != 0u ? final_color(c, ivec2(gl_FragCoord.xy), final_params) : c;
}

// Resized light at a fine pixel of colour `seen`; `bits` of doubt, see lod_up.glsl.
void put(vec3 light, vec4 seen, float bits) {
    vec3 own = from_srgb(seen.rgb);
    bool own_color = kKeepBackground != 0u && seen.a == 0.0;
    if (kFineGrained != 0u) light *= own;
    put_linear(vec4(own_color ? own : light, seen.a));
    if (kDoubt != 0u) out_doubt = own_color ? 0.0 : doubt_of(bits);
}
