#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/camera_model.h"

namespace kino {

/// Pinhole and Brown-Conrady distortion of one camera, both ways, in double. With x, y the
/// undistorted ray at z = 1 and s = x^2 + y^2 (OpenCV's order and meaning):
///   g  = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
///   x' = g x + 2 p1 x y + p2 (s + 2 x^2)
///   y' = g y + p1 (s + 2 y^2) + 2 p2 x y
/// and the pixel is (fx x' + cx, fy y' + cy), pixel centres at integers.
///
/// The map is the gradient of a potential, so it is one-to-one on every disc where its (symmetric)
/// derivative is positive definite. The largest such disc is found once; outside it the polynomial
/// folds back or the denominator has crossed zero, and both directions say "invalid".
class Projection {
  public:
    /// The camera must pass validate().
    explicit Projection(const CameraModel& camera);

    [[nodiscard]] const CameraModel& camera() const { return camera_; }
    /// Radius of that disc at z = 1; infinite without distortion.
    [[nodiscard]] double max_radius() const { return max_radius_; }

    /// Camera space, metres, to pixels. None for z <= 0, anything not finite, or a ray outside the
    /// one-to-one disc. Says nothing about the borders of the image.
    [[nodiscard]] std::optional<glm::dvec2> project(const glm::dvec3& point) const;
    /// Pixel to the ray's x, y at z = 1. None where no ray inside the disc leads to that pixel.
    [[nodiscard]] std::optional<glm::dvec2> unproject(const glm::dvec2& pixel) const;
    /// As unproject(), but a finite pixel without a ray gets the one on the disc's rim that points
    /// the same way from the principal point.
    [[nodiscard]] glm::dvec2 unproject_clamped(const glm::dvec2& pixel) const;

    /// The distortion alone, on rays at z = 1.
    [[nodiscard]] std::optional<glm::dvec2> distort(const glm::dvec2& ray) const;
    [[nodiscard]] std::optional<glm::dvec2> undistort(const glm::dvec2& distorted) const;

  private:
    CameraModel camera_;
    bool distorted_;
    double max_radius_;
};

/// The same camera read out at another size: pixel edges, not centres, keep their place, so the
/// centre of the picture stays its centre (640x480 <-> 320x240).
[[nodiscard]] CameraModel scaled(const CameraModel& camera, int width, int height);
/// The same camera showing only the rectangle whose first pixel is (left, top).
[[nodiscard]] CameraModel cropped(const CameraModel& camera, int left, int top, int width,
                                  int height);

}  // namespace kino
