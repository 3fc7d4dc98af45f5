#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/quality/lod_fix_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { LodFixParams p; };
layout(constant_id = 0) const uint kStep = 0u;  // of the five below
layout(set = 0, binding = 0) uniform sampler2D doubt;
layout(scalar, set = 0, binding = 1) buffer State { LodFixState state; };
layout(scalar, set = 0, binding = 2) buffer Counts { uint count_of_strip[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer Listed { uint pixels[]; };

struct Strip {
    uint first_x;
    uint y;
    uint width;
};
Strip strip_of(uint i) {
    uint x = i % p.strips * KINO_LOD_STRIP_PX;
    return Strip(x, i / p.strips, min(KINO_LOD_STRIP_PX, p.fine.x - x));
}
uint doubt_at(Strip s, uint k) {
    return uint(texelFetch(doubt, ivec2(s.first_x + k, s.y), 0).r * 255.0 + 0.5);
}
// A number of 16 bits that looks random and is always the same for a pixel (Wellons'
// lowbias32, public domain).
uint scattered(uint x, uint y) {
    uint h = y << 16 | x;
    h = (h ^ (h >> 16)) * 0x7FEB352Du;
    h = (h ^ (h >> 15)) * 0x846CA68Bu;
    return (h ^ (h >> 16)) & 0xFFFFu;
}
// Where not all fit, the most doubtful come first, and of the last kind a share from everywhere.
bool listed(Strip s, uint k) {
    uint d = doubt_at(s, k);
    return d > state.cut || (d == state.cut && scattered(s.first_x + k, s.y) < state.share);
}

// 0: how many in each strip are doubtful enough, and the histogram of those.
void count_strips() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.all_strips) return;
    Strip s = strip_of(i);
    uint n = 0u;
    for (uint k = 0u; k < s.width; ++k) n += doubt_at(s, k) >= p.least ? 1u : 0u;
    count_of_strip[i] = n;
    for (uint k = 0u; k < (n > 0u ? s.width : 0u); ++k) {
        uint d = doubt_at(s, k);
        if (d >= p.least) atomicAdd(state.bins[min(d, kDoubtBins - 1u)], 1u);
    }
}

// 1, one lane: the least cut with which the list is not longer than the cap.
void choose_cut() {
    if (gl_GlobalInvocationID.x != 0u) return;
    uint all = 0u;
    for (uint d = p.least; d < kDoubtBins; ++d) all += state.bins[d];
    uint above = 0u;
    uint cut = kDoubtBins - 1u;
    while (cut > p.least && above + state.bins[cut] <= p.cap) {
        above += state.bins[cut];
        --cut;
    }
    uint here = state.bins[cut];
    // A little less than what fits: scattered pixels are not counted one by one.
    state.share = above + here <= p.cap
                      ? 0x10000u
                      : uint(float(p.cap - above) / float(here) * 0.97 * 65536.0);
    state.cut = cut;
    state.failed = all;
}

// 2: what of each strip is listed, where that is not all that is doubtful.
void count_listed() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.all_strips) return;
    Strip s = strip_of(i);
    uint before = count_of_strip[i];
    uint n = 0u;
    for (uint k = 0u; k < (before > 0u && state.failed > p.cap ? s.width : 0u); ++k) {
        n += listed(s, k) ? 1u : 0u;
    }
    count_of_strip[i] = state.failed > p.cap ? n : before;
}

// 3, one lane: counts become places, rows from above.
void sum_strips() {
    if (gl_GlobalInvocationID.x != 0u) return;
    uint sum = 0u;
    for (uint i = 0u; i < p.all_strips; ++i) {
        uint n = count_of_strip[i];
        count_of_strip[i] = sum;
        sum += n;
    }
    state.count = min(sum, p.cap);
    state.groups_x = (state.count + 63u) / 64u;
    state.groups_y = 1u;
    state.groups_z = 1u;
}

// 4: the list; a strip writes nothing beyond the cap.
void write_list() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= p.all_strips) return;
    Strip s = strip_of(i);
    uint place = count_of_strip[i];
    uint end = i + 1u < p.all_strips ? count_of_strip[i + 1u] : 0xFFFFFFFFu;
    for (uint k = 0u; k < (end > place && place < p.cap ? s.width : 0u); ++k) {
        if (listed(s, k) && place < p.cap) pixels[place++] = s.y << 16 | (s.first_x + k);
    }
}

void main() {
    if (kStep == 0u) count_strips();
    if (kStep == 1u) choose_cut();
    if (kStep == 2u) count_listed();
    if (kStep == 3u) sum_strips();
    if (kStep == 4u) write_list();
}
