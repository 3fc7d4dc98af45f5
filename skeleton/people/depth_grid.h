#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// Pixels [first, last) of a row or column.
struct PixelSpan {
    int first = 0, last = 0;
};

/// A depth picture in cells of cell x cell pixels. A cell's reading is that of one of four of its
/// pixels, the second nearest, so it never lies between two surfaces and one stray pixel in front
/// of a surface does not move it.
class DepthGrid {
  public:
    static constexpr float kMinDepthM = 0.1f, kMaxDepthM = 20.0f;

    /// `rays` are those of the full picture, at least one cell large; cell_px >= 1.
    DepthGrid(const Image<RayXy>& rays, int cell_px);

    /// Depth in metres, the rays' size. What is not a number from kMinDepthM to kMaxDepthM, or has
    /// no ray, is no reading.
    void sample(const Image<float>& depth_m);

    [[nodiscard]] int width() const { return z_.width(); }
    [[nodiscard]] int height() const { return z_.height(); }
    [[nodiscard]] int cell_px() const { return cell_px_; }
    [[nodiscard]] const Image<float>& z_m() const { return z_; }  ///< 0: no reading
    [[nodiscard]] glm::vec3 point(std::size_t cell) const {
        const RayXy& ray = pick_[cell];
        const float z = z_.data()[cell];
        return {ray.x * z, ray.y * z, z};
    }
    /// The cell in which a point of depth-camera space is seen, as a pinhole that is fitted to the
    /// rays tells (a lens's distortion is not followed); -1 if none or behind the camera.
    [[nodiscard]] std::int32_t cell_of(const glm::vec3& p) const {
        if (!(p.z > kMinDepthM)) return -1;
        const float x = focal_x_ * p.x / p.z + middle_x_, y = focal_y_ * p.y / p.z + middle_y_;
        if (!(x >= 0 && y >= 0)) return -1;
        const auto column = static_cast<int>(x), line = static_cast<int>(y);
        return column < width() && line < height() ? line * width() + column : -1;
    }
    /// Edge of a cell at one metre, metres: its area at depth z is (z * this)^2.
    [[nodiscard]] float cell_tangent() const { return cell_tangent_; }
    [[nodiscard]] PixelSpan columns(int cell_x) const { return span(cell_x, width(), full_width_); }
    [[nodiscard]] PixelSpan rows(int cell_y) const { return span(cell_y, height(), full_height_); }

  private:
    void fit_pinhole(const Image<RayXy>& rays);
    [[nodiscard]] PixelSpan span(int cell, int cells, int pixels) const {
        return {cell * cell_px_, cell + 1 == cells ? pixels : (cell + 1) * cell_px_};
    }

    int cell_px_;
    int full_width_, full_height_;
    float cell_tangent_ = 0;
    float focal_x_ = 1, middle_x_ = 0, focal_y_ = 1, middle_y_ = 0;  // cells of a ray
    std::vector<RayXy> rays_;  // of the four samples of each cell, one after the other
    Image<float> z_;
    std::vector<RayXy> pick_;
};

}  // namespace kino
