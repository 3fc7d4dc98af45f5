#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace kino {

/// A cell in front of the room, as the person test and the tracker need it.
struct CellPoint {
    std::int32_t cell = 0;
    glm::vec3 upright_m{0};  ///< y is the height above the floor, if that is known
    float area_m2 = 0;
    bool known = false;      ///< the background there is known
    bool changed = false;    ///< its depth is not what it was a moment ago
    bool border = false;     ///< at the left, right or upper edge of what can be seen
    std::uint8_t sides = 0;  ///< neighbours to the left, right and above that are not its own
    std::uint8_t free = 0;   ///< of these, how many are farther away or without a reading
};

/// What is known of one connected surface.
struct Blob {
    std::vector<CellPoint> cells;
    glm::vec3 centroid_m{0}, min_m{0}, max_m{0};  ///< upright axes
    float area_m2 = 0;
    float known = 0;    ///< share of cells whose background is known
    float changed = 0;  ///< share of cells that changed
    float free = 0;     ///< share of the outline beyond which it is farther
    bool border = false;
    bool shared = false;  ///< part of a surface that holds several people
    void measure();       ///< everything but `cells` and `shared`
};

struct PersonTest {
    bool floor_known = false;
    float min_area_m2 = 0.12f, max_area_m2 = 2.2f;
    float min_top_m = 1.0f, max_top_m = 2.4f;  ///< highest point above the floor
    float max_width_m = 2.3f;                  ///< horizontally: both arms stretched out
    float min_height_m = 0.45f;                ///< vertical extent
    // Where there is no background to tell:
    float min_free = 0.6f;  ///< of the outline
    float min_free_area_m2 = 0.2f;
    float min_free_width_m = 0.2f;  ///< area over height: a floor lamp has 0.16

    /// Somebody, as he may first be seen. Chairs are too low, tables too low and too bound to the
    /// room, shelves and walls are not free of what is around them; lamps and plants too thin.
    [[nodiscard]] bool accepts(const Blob& blob) const;
    /// For somebody who is already known and seen in part.
    [[nodiscard]] bool accepts_part(const Blob& blob) const;
};

}  // namespace kino
