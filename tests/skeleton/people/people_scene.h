#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/pose.h"
#include "calibration/rig.h"
#include "skeleton/synthetic/scene.h"
#include "skeleton/synthetic/visibility.h"

namespace kino::test {

/// A person: the pose, and where it was moved to as a whole (lying down, say).
struct Actor {
    BodyPose pose;
    Pose world_from_body;
};

/// At (x, z) of the world (the camera looks along -z from (0, height, 0)), in a motion's pose.
[[nodiscard]] Actor actor_at(double x, double z, Motion motion = Motion::idle, double t_s = 0,
                             double yaw_rad = 0);
/// On the back, head to the right, across the view.
[[nodiscard]] Actor lying_at(double x, double z);

struct RoomOptions {
    int width = 320, height = 240;
    double tilt_deg = -3;  ///< upwards
    double roll_deg = 0;
    double camera_height_m = 1.05;
    double camera_x_m = 0;
    double back_wall_m = 4.4;
    bool furniture = true;
    bool noise = true;
};

/// Several people in the synthetic room: the nearest of several pictures with one person each.
/// Noise is that of a Kinect v1: 0.46 steps of disparity, rounding, lost edges and shadows.
class PeopleScene {
  public:
    explicit PeopleScene(const RoomOptions& options = {});

    /// `index` picks the noise.
    void draw(std::span<const Actor> actors, std::uint64_t index);

    [[nodiscard]] const Image<float>& depth_m() const { return depth_; }
    /// 0 nobody, else the actor's index plus 1; only where there is a reading.
    [[nodiscard]] const Image<std::uint8_t>& truth() const { return truth_; }
    [[nodiscard]] const Image<RayXy>& rays() const { return rays_; }
    /// Up in depth-camera space, and the camera's height.
    [[nodiscard]] glm::vec3 up() const;
    [[nodiscard]] double camera_height_m() const { return options_.camera_height_m; }

  private:
    void add_noise(std::uint64_t index);

    RoomOptions options_;
    SyntheticScene scene_;
    std::unique_ptr<Visibility> seen_;
    Image<float> exact_, depth_;
    Image<std::uint8_t> truth_, lit_;
    Image<RayXy> rays_;
    std::vector<float> normal_;
};

}  // namespace kino::test
