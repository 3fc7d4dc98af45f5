// Bit-trail traversal of the heap (GPU Pro 4, Murguia et al.). The includer declares
// `usamplerBuffer bvh_nodes, bvh_triangles` and asks only where the tree is not empty.
#include "viz/accel/ray_tests.glsl"

const uint kNoTriangle = 0xFFFFFFFFu;

struct FoundHit {
    float t;
    uint triangle;
    vec2 weights;
};

// The next node after all below n is done; the traversal is over when the trail is 1.
void bvh_pop(inout uint n, inout uint trail) {
    int up = findLSB(trail + 1u);
    trail = (trail >> up) + 1u;
    n = (n >> up) ^ 1u;
}

// Walks until the next leaf of `nodes` whose box is met, and steps past it; its triangles are
// [first, first + count). Count 0: there is no other.
void bvh_next_leaf(usamplerBuffer nodes, RayTest r, float best, inout uint n, inout uint trail,
                   out uint first, out uint count) {
    count = 0u;
    first = 0u;
    while (trail > 0u && count == 0u) {
        uvec4 low = texelFetch(nodes, int(2u * n));
        uvec4 high = texelFetch(nodes, int(2u * n + 1u));
        bool met = meets_box(r, uintBitsToFloat(low.xyz), uintBitsToFloat(high.xyz), best);
        bool leaf = (high.w & 4u) != 0u;
        bool down = met && !leaf;
        count = met && leaf ? high.w >> 3u : 0u;
        first = low.w;
        uint axis = high.w & 3u;
        bool far = axis == 0u ? r.negative.x : (axis == 1u ? r.negative.y : r.negative.z);
        uint up_n = n;
        uint up_trail = trail;
        bvh_pop(up_n, up_trail);
        // A trail of 1 after a pop is the end; 0 says so to the loops.
        n = down ? 2u * n + (far ? 1u : 0u) : up_n;
        trail = down ? trail << 1u : (up_trail > 1u ? up_trail : 0u);
    }
}

uint bvh_start_trail(uint start) { return 1u << findMSB(start); }

FoundHit bvh_closest(RayTest r, float t_max, uint start) {
    FoundHit best = FoundHit(t_max, kNoTriangle, vec2(0.0));
    uint n = start;
    uint trail = r.valid ? bvh_start_trail(start) : 0u;
    while (trail > 0u) {
        uint first, count;
        bvh_next_leaf(bvh_nodes, r, best.t, n, trail, first, count);
        for (uint i = 0u; i < count; ++i) {
            int at = int(3u * (first + i));
            uvec4 a = texelFetch(bvh_triangles, at);
            uvec4 b = texelFetch(bvh_triangles, at + 1);
            uvec4 c = texelFetch(bvh_triangles, at + 2);
            float t;
            vec2 weights;
            bool met = meets_triangle(r, uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz),
                                      uintBitsToFloat(c.xyz), best.t, t, weights);
            if (met && (t < best.t || a.w < best.triangle)) best = FoundHit(t, a.w, weights);
        }
    }
    if (best.triangle == kNoTriangle) best.t = uintBitsToFloat(0x7F800000u);
    return best;
}

bool bvh_any_of(usamplerBuffer nodes, usamplerBuffer triangles, RayTest r, float t_max) {
    uint n = 1u;
    uint trail = r.valid ? 1u : 0u;
    bool found = false;
    while (trail > 0u) {
        uint first, count;
        bvh_next_leaf(nodes, r, t_max, n, trail, first, count);
        for (uint i = 0u; i < count; ++i) {
            int at = int(3u * (first + i));
            float t;
            vec2 weights;
            bool met = meets_triangle(r, uintBitsToFloat(texelFetch(triangles, at).xyz),
                                      uintBitsToFloat(texelFetch(triangles, at + 1).xyz),
                                      uintBitsToFloat(texelFetch(triangles, at + 2).xyz),
                                      t_max, t, weights);
            found = found || met;
            count = found ? 0u : count;
        }
        trail = found ? 0u : trail;
    }
    return found;
}

bool bvh_any(RayTest r, float t_max) { return bvh_any_of(bvh_nodes, bvh_triangles, r, t_max); }
