#include "skeleton/people/blob.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "skeleton/people/blob_relations.h"

namespace kino {
namespace {

constexpr float kMostlyKnown = 0.5f;

/// Least standard deviation in any direction: how far from a plane it is. The smallest eigenvalue
/// of the covariance, by the trigonometric solution for symmetric 3x3 matrices (Smith 1961).
float thickness_m(const Blob& blob) {
    glm::dmat3 c(0.0);
    double weight = 0;
    for (const CellPoint& p : blob.cells) {
        const glm::dvec3 off(p.upright_m - blob.centroid_m);
        c += static_cast<double>(p.area_m2) * glm::outerProduct(off, off);
        weight += static_cast<double>(p.area_m2);
    }
    if (!(weight > 0)) return 0;
    c *= 1 / weight;
    const double mean = (c[0][0] + c[1][1] + c[2][2]) / 3;
    const glm::dmat3 b = c - mean * glm::dmat3(1.0);
    double square = 0;
    for (int i = 0; i < 3; ++i) square += glm::dot(b[i], b[i]);
    const double p = std::sqrt(square / 6);
    if (!(p > 1e-12)) return static_cast<float>(std::sqrt(std::max(mean, 0.0)));
    const double r = std::clamp(glm::determinant(b) / (2 * p * p * p), -1.0, 1.0);
    const double least = mean + 2 * p * std::cos((std::acos(r) + 2 * std::numbers::pi) / 3);
    return static_cast<float>(std::sqrt(std::max(least, 0.0)));
}

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
    int known_cells = 0, changed_cells = 0, mine_cells = 0, sides = 0, free_sides = 0;
    border = false;
    for (const CellPoint& c : cells) {
        min_m = glm::min(min_m, c.upright_m);
        max_m = glm::max(max_m, c.upright_m);
        sum += static_cast<double>(c.area_m2) * glm::dvec3(c.upright_m);
        area += static_cast<double>(c.area_m2);
        known_cells += c.known ? 1 : 0;
        changed_cells += c.changed ? 1 : 0;
        mine_cells += c.mine ? 1 : 0;
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
    mine = share(mine_cells, cells.size());
    changed = share(changed_cells, cells.size());
    free = share(free_sides, static_cast<std::size_t>(sides));
}

void Blob::drop_knees() {
    const std::vector<BlobHead> all = heads;
    std::erase_if(heads, [&](const BlobHead& h) {
        return std::any_of(all.begin(), all.end(), [&](const BlobHead& other) {
            const glm::vec3 off = other.upright_m - h.upright_m;
            return off.y > 0.35f && std::hypot(off.x, off.z) < 0.5f && other.score > h.score - 0.2f;
        });
    });
}

float Blob::head_score() const {
    float best = 0;
    for (const BlobHead& h : heads) best = std::max(best, h.score);
    return best;
}

bool PersonTest::accepts(const Blob& blob) const {
    if (blob.area_m2 < std::min(min_area_m2, min_head_area_m2) || blob.area_m2 > max_area_m2)
        return false;
    const float wide = horizontal(blob), high = blob.max_m.y - blob.min_m.y;
    if (wide > max_width_m) return false;
    const bool in_front = blob.known > kMostlyKnown;
    const bool headed = std::any_of(blob.heads.begin(), blob.heads.end(), [&](const BlobHead& h) {
        return clear_head(blob, h) || (in_front && above_floor(h));
    });
    if (headed && blob.area_m2 >= min_head_area_m2 && high >= 0.3f && high <= max_top_m &&
        (!floor_known || blob.max_m.y <= max_top_m)) {
        return true;
    }
    if (blob.area_m2 < min_area_m2) return false;
    // Without a background only what stands out all around, and is not a panel or a pole.
    const float mean_width = blob.area_m2 / std::max(high, 0.1f);
    if (!in_front && (blob.cut || blob.free < min_free || blob.area_m2 < min_free_area_m2 ||
                      mean_width < min_free_width_m ||
                      area_around(blob, blob.centroid_m, 0.45f) < min_free_core * blob.area_m2 ||
                      thickness_m(blob) < min_thickness_m)) {
        return false;
    }
    if (lying(blob)) return true;
    if (high < min_height_m || mean_width < 0.13f || mean_width > 1.0f) return false;
    if (floor_known) {
        if (blob.max_m.y > max_top_m) return false;
        if (blob.max_m.y < min_top_m && !blob.border) return false;
    }
    return high <= max_top_m;
}

bool PersonTest::above_floor(const BlobHead& head) const {
    return !floor_known || head.upright_m.y > min_head_top_m;
}

bool PersonTest::clear_head(const Blob& blob, const BlobHead& head) const {
    if (head.score < kSureHead || (floor_known && head.upright_m.y < min_still_top_m) ||
        blob.free < min_head_free || blob.area_m2 > max_head_area_m2 ||
        std::hypot(head.upright_m.x, head.upright_m.z) > head_within_m) {
        return false;
    }
    return area_around(blob, head.upright_m, 0.35f) >= min_head_core * blob.area_m2;
}

bool PersonTest::lying(const Blob& blob) const {
    return floor_known && blob.known > kMostlyKnown && horizontal(blob) > 1.1f &&
           blob.min_m.y < 0.4f && blob.max_m.y > 0.12f && blob.max_m.y < 1.0f &&
           blob.area_m2 < 1.2f;
}

bool PersonTest::accepts_part(const Blob& blob) const {
    if (blob.area_m2 < 0.03f || blob.area_m2 > max_area_m2) return false;
    if (horizontal(blob) > max_width_m || blob.max_m.y - blob.min_m.y > max_top_m) return false;
    return blob.known > kMostlyKnown || (blob.free >= 0.5f * min_free && blob.area_m2 >= 0.08f);
}

}  // namespace kino
