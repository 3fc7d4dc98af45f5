#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "skeleton/people/depth_grid.h"
#include "skeleton/people/person.h"

namespace kino {

struct FloorOptions {
    float noise_per_m = 0.0017f;
    float max_tilt_deg = 40;       ///< of the camera's y axis against gravity, nothing known of it
    float gravity_within_deg = 8;  ///< how far the floor may be from what the accelerometer says
    float min_camera_height_m = 0.15f, max_camera_height_m = 4;
    int rounds = 60;      ///< of three random points each
    double smooth_s = 1;  ///< time constant, while the plane agrees with the last one
};

/// The lowest large level plane: RANSAC (Fischler & Bolles 1981) with a fixed seed over those
/// points of a thinned picture about which the surface is roughly level, then least squares of
/// inverse depth over all inliers, in which a plane is linear and the noise of a triangulating
/// sensor the same everywhere. Points below it speak against a plane: a table is not the floor if
/// the floor is seen as well.
class FloorFinder {
  public:
    explicit FloorFinder(const FloorOptions& options) : options_(options) {}

    void reset() { last_.reset(); }

    /// `gravity_up`: unit, depth-camera space, from the accelerometer, if there is one.
    [[nodiscard]] FloorPlane find(const DepthGrid& grid, const std::optional<glm::vec3>& gravity_up,
                                  TimeNs time);

  private:
    struct Score {
        float value = 0;  // inliers less what is below
        int inliers = 0, below = 0;
    };
    void gather(const DepthGrid& grid, const glm::vec3& prior, float within_rad);
    [[nodiscard]] float band_m(const FloorPlane& plane, float z) const;
    [[nodiscard]] Score score(const FloorPlane& plane) const;
    [[nodiscard]] bool allowed(const FloorPlane& plane, const glm::vec3& prior, float cosine) const;
    [[nodiscard]] std::optional<FloorPlane> refine(const FloorPlane& plane) const;

    FloorOptions options_;
    std::vector<glm::vec3> points_, level_;  // all votes, and those that lie about level
    std::optional<FloorPlane> last_;
    TimeNs last_time_ = 0;
};

}  // namespace kino
