layout(constant_id = 2) const uint kFillHoles = 0u;

// The visibility at a pixel; one-pixel holes between splats take their nearest neighbour.
uvec2 nearest_or_filled(uvec2 at) {
    uvec2 hit = visibility_at(at.y * p.target.x + at.x);
    // A loop whose trip count is data, so covered pixels do not pay for it.
    int tries = kFillHoles != 0u && hit.y == KINO_EMPTY ? 9 : 0;
    uint around = 0u;
    uvec2 nearest = uvec2(KINO_EMPTY);
    for (int k = 0; k < tries; ++k) {
        ivec2 q = clamp(ivec2(at) + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), ivec2(p.target) - 1);
        uvec2 other = visibility_at(uint(q.y) * p.target.x + uint(q.x));
        if (other.y != KINO_EMPTY) ++around;
        if (other.y < nearest.y) nearest = other;
    }
    // Half the neighbours present means a hole inside a surface, fewer its outer edge.
    return around >= 4u ? nearest : hit;
}
