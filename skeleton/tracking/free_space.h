#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "calibration/rig.h"
#include "skeleton/people/person.h"

namespace kino {

/// Focal lengths and centre that fit a picture of rays best.
struct PinholeFit {
    float fx = 1, fy = 1, cx = 0, cy = 0;
    [[nodiscard]] static PinholeFit of(const Image<RayXy>& rays);
    [[nodiscard]] glm::vec2 pixel(const glm::vec3& p) const {
        return {p.x / p.z * fx + cx, p.y / p.z * fy + cy};
    }
};

/// What the picture says of a place in space.
struct SpaceView {
    enum Kind : std::uint8_t {
        unknown,  ///< outside the picture, or no reading
        own,      ///< the person is seen there, at depth_m
        nearer,   ///< something else may hide the person there
        free,     ///< something farther than the person is seen: the person is not there
    };
    Kind kind = unknown;
    float depth_m = 0;
    glm::vec2 to_own_px{0};  ///< if free: to the nearest pixel that is not
};

/// Where around one person nothing can be, in cells of a few pixels: the complement of the visual
/// hull and what is in front of the person's surface. Reuses its memory.
class FreeSpace {
  public:
    /// `labels` as PeopleFrame has them; the person is the pixels with `slot`, within `box`.
    /// Readings nearer than `far_m` that are not the person may hide a part of him.
    void set(const Image<float>& depth_m, const Image<std::uint8_t>& labels, std::uint8_t slot,
             const PixelBox& box, int cell_px, float far_m);

    /// `pixel` in image coordinates.
    [[nodiscard]] SpaceView at(const glm::vec2& pixel) const;

  private:
    struct Cell {
        float depth_m;
        SpaceView::Kind kind;
        std::int16_t dx, dy;  // to the nearest cell that is not free
    };
    int width_ = 0, height_ = 0, cell_px_ = 1, left_ = 0, top_ = 0;
    std::vector<Cell> cells_;
};

}  // namespace kino
