#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "skeleton/synthetic/scene.h"
#include "skeleton/synthetic/visibility.h"

namespace kino {

/// The colour camera: the room is painted once, several samples a pixel where surfaces meet; each
/// frame paints the person and the dark spots under it.
class ColorSensor {
  public:
    /// The scene must pass validate() and have a colour camera.
    explicit ColorSensor(const SyntheticScene& scene);

    /// Fills `rgba` (R in the lowest byte, rows without padding).
    void draw(std::span<const Primitive> person, const Body* body, std::span<std::uint32_t> rgba);

    [[nodiscard]] const Visibility& visibility() const { return seen_; }

  private:
    void paint_room(const SyntheticScene& scene);

    Pose world_from_depth_;
    Visibility seen_;
    raycast::Lights lights_;
    Image<std::uint32_t> still_;
    Image<float> floor_x_, floor_z_;
};

}  // namespace kino
