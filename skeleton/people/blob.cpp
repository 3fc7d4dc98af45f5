#include "skeleton/people/blob.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

namespace kino {
namespace {

constexpr float kMostlyKnown = 0.5f;

float horizontal(const Blob& blob) {
    return std::hypot(blob.max_m.x - blob.min_m.x, blob.max_m.z - blob.min_m.z);
}

}  // namespace

void Blob::measure() {
    constexpr float kFar = std::numeric_limits<float>::max();
    min_m = glm::vec3(kFar);
    max_m = glm::vec3(-kFar);
    glm::dvec3 sum(0.0);
    double area = 0;
    int known_cells = 0, changed_cells = 0, sides = 0, free_sides = 0;
    border = false;
    for (const CellPoint& c : cells) {
        min_m = glm::min(min_m, c.upright_m);
        max_m = glm::max(max_m, c.upright_m);
        sum += static_cast<double>(c.area_m2) * glm::dvec3(c.upright_m);
        area += static_cast<double>(c.area_m2);
        known_cells += c.known ? 1 : 0;
        changed_cells += c.changed ? 1 : 0;
        border = border || c.border;
        sides += c.sides;
        free_sides += c.free;
    }
    area_m2 = static_cast<float>(area);
    centroid_m = area > 0 ? glm::vec3(sum / area) : glm::vec3(0);
    const auto share = [](int part, std::size_t whole) {
        return whole == 0 ? 0.0f : static_cast<float>(part) / static_cast<float>(whole);
    };
    known = share(known_cells, cells.size());
    changed = share(changed_cells, cells.size());
    free = share(free_sides, static_cast<std::size_t>(sides));
}

bool PersonTest::accepts(const Blob& blob) const {
    if (blob.area_m2 < min_area_m2 || blob.area_m2 > max_area_m2) return false;
    const float wide = horizontal(blob), high = blob.max_m.y - blob.min_m.y;
    if (wide > max_width_m) return false;
    const bool in_front = blob.known > kMostlyKnown;
    // Without a background only what stands out all around, and is not a panel or a pole.
    const float mean_width = blob.area_m2 / std::max(high, 0.1f);
    if (!in_front && (blob.free < min_free || blob.area_m2 < min_free_area_m2 ||
                      mean_width < min_free_width_m)) {
        return false;
    }
    const bool lying = floor_known && in_front && wide > 1.1f && blob.min_m.y < 0.4f &&
                       blob.max_m.y > 0.12f && blob.max_m.y < 1.0f && blob.area_m2 < 1.2f;
    if (lying) return true;
    if (high < min_height_m || mean_width < 0.13f || mean_width > 1.0f) return false;
    if (floor_known) {
        if (blob.max_m.y > max_top_m) return false;
        if (blob.max_m.y < min_top_m && !blob.border) return false;
    }
    return high <= max_top_m;
}

bool PersonTest::accepts_part(const Blob& blob) const {
    if (blob.area_m2 < 0.03f || blob.area_m2 > max_area_m2) return false;
    if (horizontal(blob) > max_width_m || blob.max_m.y - blob.min_m.y > max_top_m) return false;
    return blob.known > kMostlyKnown || (blob.free >= 0.5f * min_free && blob.area_m2 >= 0.08f);
}

}  // namespace kino
