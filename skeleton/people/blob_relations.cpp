#include "skeleton/people/blob_relations.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

constexpr float kHeldBeforeM = 0.25f;

float gap(float min_a, float max_a, float min_b, float max_b) {
    return std::max({0.0f, min_b - max_a, min_a - max_b});
}

}  // namespace

float level_distance(const glm::vec3& a, const glm::vec3& b) {
    return std::hypot(a.x - b.x, a.z - b.z);
}

float area_around(const Blob& blob, const glm::vec3& middle, float within_m) {
    float sum = 0;
    for (const CellPoint& c : blob.cells) {
        if (level_distance(c.upright_m, middle) < within_m) sum += c.area_m2;
    }
    return sum;
}

float apart(const Blob& a, const Blob& b, float sideways_m, float upwards_m) {
    const float x = gap(a.min_m.x, a.max_m.x, b.min_m.x, b.max_m.x) / sideways_m;
    const float y = gap(a.min_m.y, a.max_m.y, b.min_m.y, b.max_m.y) / upwards_m;
    // z is towards the camera: what is held before the body is an arm's length away.
    const float before = std::max(0.0f, a.min_m.z - b.max_m.z) / (sideways_m + kHeldBeforeM);
    const float behind = std::max(0.0f, b.min_m.z - a.max_m.z) / sideways_m;
    return std::hypot(x, y, before + behind);
}

bool trunk_of(const Blob& main, const Blob& piece) {
    return !piece.cut && piece.area_m2 < 0.6f &&
           std::any_of(main.heads.begin(), main.heads.end(), [&](const BlobHead& h) {
               const float down = h.upright_m.y - piece.centroid_m.y;
               return level_distance(h.upright_m, piece.centroid_m) < 0.3f && down > 0.15f &&
                      down < 0.9f;
           });
}

bool limb_of(const Blob& main, const Blob& piece) {
    if (piece.mine < 0.5f) return false;
    const glm::vec3 middle = main.heads.empty() ? main.centroid_m : main.heads.front().upright_m;
    // Behind the shoulders is the back of his chair.
    if (!main.heads.empty() && middle.z - piece.centroid_m.z > 0.16f &&
        middle.y - piece.centroid_m.y < 0.75f) {
        return false;
    }
    return piece.changed > 0.15f || level_distance(middle, piece.centroid_m) < 0.45f;
}

bool independent(const Blob& blob) {
    if (blob.mine > 0.5f) return false;  // was somebody's a moment ago
    return blob.head_score() >= kSureHead ? blob.area_m2 > 0.15f
                                          : blob.head_score() > 0 && blob.area_m2 > 0.3f;
}

}  // namespace kino
