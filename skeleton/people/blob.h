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
    bool mine = false;       ///< was somebody's in the picture before
    bool border = false;     ///< at the left, right or upper edge of what can be seen
    std::uint8_t sides = 0;  ///< neighbours to the left, right and above that are not its own
    std::uint8_t free = 0;   ///< of these, how many are farther away or without a reading
};

constexpr float kSureHead = 0.8f;

/// A place on a surface that looks like a head.
struct BlobHead {
    glm::vec3 upright_m{0};
    float score = 0;
};

/// What is known of one connected surface.
struct Blob {
    std::vector<CellPoint> cells;
    glm::vec3 centroid_m{0}, min_m{0}, max_m{0};  ///< upright axes
    float area_m2 = 0;
    float known = 0;    ///< share of cells whose background is known
    float changed = 0;  ///< share of cells that changed
    float mine = 0;     ///< share of cells that were somebody's
    float free = 0;     ///< share of the outline beyond which it is farther
    bool border = false;
    bool cut = false;                        ///< what hung together with it was out of reach
    bool shared = false;                     ///< part of a surface that holds several people
    std::vector<BlobHead> heads;             ///< seen on it
    void measure();                          ///< everything but `cells`, `shared` and `heads`
    void drop_knees();                       ///< heads that hang below another head
    [[nodiscard]] float head_score() const;  ///< of the best; 0 without one
};

struct PersonTest {
    bool floor_known = false;
    float min_area_m2 = 0.12f, max_area_m2 = 2.2f;
    float min_top_m = 1.0f, max_top_m = 2.4f;  ///< highest point above the floor
    float max_width_m = 2.3f;                  ///< horizontally: both arms stretched out
    float min_height_m = 0.45f;                ///< vertical extent
    float min_head_area_m2 = 0.06f;            ///< with a head the rest may be hidden
    // Where there is no background to tell:
    float min_free = 0.6f;  ///< of the outline
    float min_free_area_m2 = 0.2f;
    float min_free_width_m = 0.2f;   ///< area over height: a floor lamp has 0.16
    float min_thickness_m = 0.025f;  ///< standard deviation from a plane: panels have none
    float min_free_core = 0.6f;      ///< share of the area within 0.45 m of the centroid
    // With a head, so near that its outline is no noise:
    float head_within_m = 3.5f;
    float min_head_free = 0.7f;     ///< of the outline: the seat and the desk are not
    float min_head_top_m = 0.55f;   ///< above the floor
    float min_still_top_m = 0.95f;  ///< and for what has not moved: chairs are lower
    float max_head_area_m2 = 1.1f;
    float min_head_core = 0.55f;  ///< share of the area within 0.35 m of the head, seen from above

    /// Somebody, as he may first be seen. Chairs are too low, tables too low and too bound to the
    /// room, shelves and walls are not free of what is around them; lamps and plants too thin.
    [[nodiscard]] bool accepts(const Blob& blob) const;
    [[nodiscard]] bool above_floor(const BlobHead& head) const;
    /// A head that says enough where no background is known.
    [[nodiscard]] bool clear_head(const Blob& blob, const BlobHead& head) const;
    /// Somebody on the floor, before a known room.
    [[nodiscard]] bool lying(const Blob& blob) const;
    /// For somebody who is already known and seen in part.
    [[nodiscard]] bool accepts_part(const Blob& blob) const;
};

}  // namespace kino
