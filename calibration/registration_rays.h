#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "base/camera_model.h"
#include "base/image.h"

namespace kino::registration {

/// The rays (at z = 1, in double) of every `step`th pixel of a camera and of its last column and
/// row; bilinear interpolation gives the others. NaN where the distortion has no inverse.
///
/// Where the interpolation would be off by more than kWorstTablePx between four nodes (asked at up
/// to nine places), or one of the nodes has no ray, the pixels there keep rays of their own: a lens
/// that folds back near the border costs memory there, not accuracy.
struct RayNodes {
    static constexpr double kWorstTablePx = 0.05;
    struct Exact {
        std::size_t pixel;  ///< y * width + x
        glm::dvec2 ray;
    };
    int width = 0;  ///< of the picture, px
    int height = 0;
    int step = 1;
    Image<glm::dvec2> nodes;
    std::vector<Exact> exact;  ///< by rising pixel
};

/// The camera must be valid, `step` at least 1.
[[nodiscard]] RayNodes find_rays(const CameraModel& camera, int step);

/// Such rays turned into another camera's axes, in float, for reading pixel after pixel.
class RayTable {
  public:
    RayTable() = default;
    RayTable(const RayNodes& nodes, const glm::dmat3& rotation);

    /// Rays of the pixels [first, first + n) in row order; n floats to each of the three.
    void read(std::size_t first, std::size_t n, float* x, float* y, float* z) const;
    /// The channel's floats, one a pixel, where the step is 1; else null.
    [[nodiscard]] const float* whole(int channel) const {
        return step_ == 1 ? channel_[static_cast<std::size_t>(channel)].data() : nullptr;
    }
    /// What the rays take in memory.
    [[nodiscard]] std::size_t bytes() const;

  private:
    struct Exact {
        std::size_t pixel;
        std::array<float, 3> ray;
    };
    void read_row(int y, int first, int n, const std::array<float*, 3>& out) const;

    int width_ = 0;
    int height_ = 0;
    int step_ = 1;
    float inverse_step_ = 1;
    int columns_ = 0;  // nodes a row
    std::array<std::vector<float>, 3> channel_;
    std::vector<Exact> exact_;
};

}  // namespace kino::registration
