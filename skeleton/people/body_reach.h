#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"

namespace kino {

/// Whether somebody whose face is at `head` can have a part of the body at `point`: upright axes,
/// metres. Generous: arms stretched out, legs of the seated.
[[nodiscard]] bool within_reach(const glm::vec3& head, const glm::vec3& point);

/// Cuts people out of surfaces that they share with the furniture they touch.
class BodyReach {
  public:
    struct Anchor {
        std::int32_t cell = 0;  ///< on the person
        glm::vec3 head_m{0};    ///< upright
    };

    /// `labels`: components. In those that hold an anchor, what is neither `certain` (not 0: known
    /// to stand before the room) nor within reach of an anchor and joined to its cell by what is,
    /// becomes 0. Components without an anchor stay as they are. All of one size.
    void cut(const std::vector<Anchor>& anchors, const std::vector<glm::vec3>& upright_m,
             const Image<std::uint8_t>& certain, Image<std::int32_t>& labels);

  private:
    std::vector<std::uint8_t> kept_;
    std::vector<std::int32_t> open_;
};

}  // namespace kino
