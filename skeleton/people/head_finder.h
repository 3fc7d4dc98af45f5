#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "skeleton/people/depth_grid.h"

namespace kino {

constexpr float kLeastHeadScore = 0.6f;

/// A place that looks like a head above shoulders.
struct Head {
    std::int32_t cell = 0;  ///< in the middle of the face
    glm::vec3 place_m{0};   ///< its surface, depth-camera space
    float score = 0;        ///< 0..1
};

/// Finds heads by the outline of head and shoulders: a surface as large as a face, free to both
/// sides and above, with shoulders and a chest at about the same distance below. Sideways, with a
/// hand beside the head or a shoulder hidden the score is lower. The outline is measured along the
/// upright axes, so a tilted or rolled sensor does not matter once the floor is known.
class HeadFinder {
  public:
    /// `mask`: not 0 where a head may be, the grid's size. `up`: unit, depth-camera space. Heads in
    /// the order of falling scores, at least 0.25 m apart.
    void find(const DepthGrid& grid, const Image<std::uint8_t>& mask, const glm::vec3& up);

    [[nodiscard]] const std::vector<Head>& heads() const { return heads_; }

  private:
    std::vector<Head> heads_, candidates_;
};

}  // namespace kino
