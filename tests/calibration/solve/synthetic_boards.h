#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/camera_model.h"
#include "base/pose.h"
#include "calibration/solve/shots.h"
#include "tests/support/random.h"

namespace kino::test {

/// Two cameras like a Kinect's and a chessboard held before them.
struct BoardScene {
    RigParameters rig;
    std::vector<glm::dvec2> corners_m;
    std::vector<Pose> first_from_board;
};

struct BoardSceneOptions {
    int views = 20;
    int columns = 9;  ///< corners
    int rows = 6;
    double square_m = 0.035;
    double nearest_m = 0.45;
    double farthest_m = 0.9;
    double least_tilt_deg = 0;
    double largest_tilt_deg = 45;
    /// Part of the picture that the boards' middles keep to: 1 all of it.
    double spread = 1;
    std::uint64_t seed = 1;
};

/// Infrared 580 px, colour 530 px, both with distortion, 25 mm and some degrees apart.
[[nodiscard]] RigParameters typical_rig();

/// Every corner of every board lies in both pictures.
[[nodiscard]] BoardScene make_scene(const RigParameters& rig, const BoardSceneOptions& options);

/// What the two cameras see, with Gaussian noise of that deviation on both coordinates.
[[nodiscard]] Shots photograph(const BoardScene& scene, double noise_px, std::uint64_t seed);

[[nodiscard]] double normal(Random& random);

}  // namespace kino::test
