layout(constant_id = 2) const uint kFillHoles = 0u;

uvec2 visibility_near(ivec2 at) {
    uvec2 q = uvec2(clamp(at, ivec2(0), ivec2(p.target) - 1));
    return visibility_at(q.y * p.target.x + q.x);
}

// The visibility at a pixel; one-pixel holes between splats take their nearest neighbour.
uvec2 nearest_or_filled(uvec2 at) {
    uvec2 hit = visibility_at(at.y * p.target.x + at.x);
    if (kFillHoles == 0u) return hit;
    // A gap in a surface has a neighbour on the left or above: only then the other six are looked
    // at, in a loop whose trip count is data, so that most pixels do not pay for it.
    uvec2 left = visibility_near(ivec2(at) - ivec2(1, 0));
    uvec2 above = visibility_near(ivec2(at) - ivec2(0, 1));
    uvec2 nearest = left.y < above.y ? left : above;
    uint around = (left.y != KINO_EMPTY ? 1u : 0u) + (above.y != KINO_EMPTY ? 1u : 0u);
    int tries = hit.y == KINO_EMPTY && around > 0u ? 6 : 0;
    const ivec2 kOthers[6] = ivec2[](ivec2(1, 0), ivec2(0, 1), ivec2(-1, -1), ivec2(1, -1),
                                     ivec2(-1, 1), ivec2(1, 1));
    for (int k = 0; k < tries; ++k) {
        uvec2 other = visibility_near(ivec2(at) + kOthers[k]);
        if (other.y != KINO_EMPTY) ++around;
        if (other.y < nearest.y) nearest = other;
    }
    // Half the neighbours present means a hole inside a surface, fewer its outer edge.
    return hit.y == KINO_EMPTY && around >= 4u ? nearest : hit;
}
