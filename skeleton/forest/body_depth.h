#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "skeleton/forest/forest_kernel.h"

namespace kino {

/// One body cut out of a depth image: everything else is background at kForestBackgroundMm, and
/// the pixels to label are listed. Reuse it from frame to frame, it keeps its memory.
class BodyDepth {
  public:
    /// `depth_mm` and `body` have the same size, at most 16384 on a side. A pixel belongs to the
    /// body where body == which and 0 < depth_mm < 32767. `focal_px` > 0: of the depth camera, or
    /// the effective one that a forest was trained for. Every `step`-th pixel of every `step`-th
    /// row is listed (all serve as neighbours).
    void set(ImageView<const std::uint16_t> depth_mm, ImageView<const std::uint8_t> body,
             std::uint8_t which, double focal_px, int step = 1);

    [[nodiscard]] std::size_t count() const { return xy_.size(); }
    /// Image coordinates of a listed pixel; they run by rows.
    [[nodiscard]] int x(std::size_t i) const { return static_cast<int>(xy_[i] & 0xFFFF) + left_; }
    [[nodiscard]] int y(std::size_t i) const { return static_cast<int>(xy_[i] >> 16) + top_; }
    /// Depth at image coordinates, mm; background wherever the body is not.
    [[nodiscard]] std::int32_t depth_mm(int x, int y) const;
    /// Pixels per quarter of a millimetre, in 2^-15.
    [[nodiscard]] std::int16_t scale(std::size_t i) const { return scale_[i]; }

    [[nodiscard]] forest::WalkImage image() const;
    [[nodiscard]] forest::WalkPixels pixels() const;
    /// The memory that image() points to.
    [[nodiscard]] std::span<const std::uint16_t> padded() const { return padded_; }

  private:
    int left_ = 0, top_ = 0;  // image coordinates of the padded picture's first pixel
    int width_ = 1, height_ = 1;
    std::vector<std::uint16_t> padded_;
    std::vector<std::uint32_t> xy_;
    std::vector<std::int16_t> scale_;
};

/// focal / depth as BodyDepth::scale has it, rounded to nearest and at most 32767 (4 px per mm).
[[nodiscard]] std::int16_t forest_scale(double focal_px, int depth_mm);

}  // namespace kino
