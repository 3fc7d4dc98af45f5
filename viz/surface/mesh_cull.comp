#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "viz/surface/mesh_shared.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { MeshCull p; };
// 0: all commands, culled ones with no instance. Compaction: 1 counts runs, 2 (one lane) says where
// each run's draws go, 3 writes them.
layout(constant_id = 0) const uint kStep = 0u;
layout(binding = 0) uniform usamplerBuffer draw_rows;
layout(scalar, binding = 1) writeonly buffer Commands { uint commands[]; };
layout(scalar, binding = 2) writeonly buffer Rows { uint row_of_draw[]; };
layout(scalar, binding = 3) buffer Counters { MeshCounters counters; };
layout(scalar, binding = 4) buffer Runs { uint runs[]; };

// 0 culled, 1 may be seen, 2 refused. False only where the sphere is provably outside; written so
// that nothing which is not a number passes.
uint judge(uint row) {
    vec4 sphere = uintBitsToFloat(texelFetch(draw_rows, int(row) * 8 + 6));
    float reach = sphere.w + 1e-5 * (length(sphere.xyz) + sphere.w);
    bool sound = sphere.w >= 0.0 && reach < 1e30;
    bool seen = sphere.z + reach >= p.near_m;
    for (int i = 0; i < 4; ++i) seen = seen && dot(p.side[i].xyz, sphere.xyz) >= -reach;
    return sound ? uint(seen) : 2u;
}

void write_command(uint at, uint row, uint instances) {
    uvec4 tail = texelFetch(draw_rows, int(row) * 8 + 7);
    commands[at * 5u] = tail.w;
    commands[at * 5u + 1u] = instances;
    commands[at * 5u + 2u] = tail.z;
    commands[at * 5u + 3u] = 0u;
    commands[at * 5u + 4u] = row;
}

void main() {
    uint lane = gl_GlobalInvocationID.x;
    if (kStep == 2u) {
        if (lane != 0u) return;
        uint total = 0u;
        for (uint run = 0u; run * KINO_CULL_RUN < p.draws; ++run) {
            uint count = runs[run];
            runs[run] = total;
            total += count;
        }
        counters.drawn = min(total, p.capacity);
        counters.overflow = total - min(total, p.capacity);
        return;
    }
    uint first = lane * KINO_CULL_RUN;
    uint last = min(first + KINO_CULL_RUN, p.draws);
    if (first >= last) return;
    uint slot = kStep == 3u ? runs[lane] : 0u;
    uint seen = 0u;
    uint refused = 0u;
    for (uint row = first; row < last; ++row) {
        uint verdict = judge(row);
        if (kStep == 0u) write_command(row, row, verdict == 1u ? 1u : 0u);
        if (kStep == 3u && verdict == 1u && slot < p.capacity) {
            write_command(slot, row, 1u);
            row_of_draw[slot] = row;
            ++slot;
        }
        seen += uint(verdict == 1u);
        refused += uint(verdict == 2u);
    }
    if (kStep == 1u) runs[lane] = seen;
    if (kStep <= 1u) {
        if (kStep == 0u) atomicAdd(counters.drawn, seen);
        atomicAdd(counters.culled, last - first - seen - refused);
        if (refused > 0u) atomicAdd(counters.refused, refused);
    }
}
