layout(constant_id = 2) const uint kFillHoles = 0u;

// The visibility at a pixel; one-pixel holes between splats take their nearest neighbour.
uvec2 nearest_or_filled(uvec2 at) {
    uvec2 hit = visibility_at(at.y * p.target.x + at.x);
    // Loops whose trip counts are data, so only what may be a hole pays: first left and above (a
    // gap in a surface has one of them), then the other six.
    bool empty = kFillHoles != 0u && hit.y == KINO_EMPTY;
    const ivec2 kAround[8] = ivec2[](ivec2(-1, 0), ivec2(0, -1), ivec2(1, 0), ivec2(0, 1),
                                     ivec2(-1, -1), ivec2(1, -1), ivec2(-1, 1), ivec2(1, 1));
    uint around = 0u;
    uvec2 nearest = uvec2(KINO_EMPTY);
    int tries = empty ? 2 : 0;
    for (int k = 0; k < tries; ++k) {
        ivec2 q = clamp(ivec2(at) + kAround[k], ivec2(0), ivec2(p.target) - 1);
        uvec2 other = visibility_at(uint(q.y) * p.target.x + uint(q.x));
        if (other.y != KINO_EMPTY) ++around;
        if (other.y < nearest.y) nearest = other;
        // One of the first two is there: look at the rest as well.
        if (k == 1 && around > 0u) tries = 8;
    }
    // Half the neighbours present means a hole inside a surface, fewer its outer edge.
    return around >= 4u ? nearest : hit;
}
