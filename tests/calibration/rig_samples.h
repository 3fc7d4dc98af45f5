#pragma once

#include <cstdint>

#include "base/camera_model.h"
#include "base/frame.h"
#include "tests/support/random.h"

namespace kino {

/// Cameras, rigs and frames for the tests of this folder; the same seed gives the same ones.
class RigSamples {
  public:
    explicit RigSamples(std::uint64_t seed) : random_(seed) {}

    double uniform(double low, double high) { return random_.real(low, high); }
    double normal(double sigma);
    glm::dvec3 direction();

    /// Field of view and distortion of real cameras, from mild webcams to the wide rational models.
    CameraModel camera(int width, int height);
    CameraModel plain_camera(int width, int height);
    /// Barrel distortion that folds back inside the picture's corners.
    static CameraModel folding_camera(int width, int height);
    /// Two cameras some centimetres and degrees apart.
    RigParameters rig(int width, int height);

    /// Millimetres: a sloping wall with boxes in front and holes.
    DepthFrame room(int width, int height);

  private:
    test::Random random_;
};

}  // namespace kino
