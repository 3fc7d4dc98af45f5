#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/camera_model.h"
#include "base/error.h"
#include "base/pose.h"
#include "skeleton/synthetic/motion.h"
#include "skeleton/synthetic/primitive.h"
#include "skeleton/synthetic/room.h"

namespace kino {

/// Everything that a synthetic recording is made of, as data: no picture has been made yet. World
/// space: y up, origin on the floor below the camera.
struct SyntheticScene {
    RoomBox room;
    std::vector<Primitive> furniture;
    Motion motion = Motion::dance;
    /// What the person does instead of `motion`, if set: pure, of any time.
    std::function<BodyPose(double t_s)> act;
    double seconds = kMotionPeriodS;  ///< the recording's length
    std::string name;                 ///< empty: the motion's
    bool person = true;
    bool tells_joints = true;  ///< the recording has a stream of true joints
    Pose world_from_depth;
    RigParameters rig;

    /// Projector to the right of the depth camera, depth-camera space, metres.
    [[nodiscard]] double emitter_x_m() const { return rig.disparity.emitter_distance_cm / 100; }
    [[nodiscard]] BodyPose pose(double t_s) const { return act ? act(t_s) : pose_at(motion, t_s); }
    /// The person's solids at time t, world space; the same number at any time. Replaces `out`.
    void person_at(double t_s, std::vector<Primitive>& out) const;
    /// True joints in depth-camera space: inferred where furniture hides them from the depth camera
    /// or they are outside its picture, else tracked. Empty without a person.
    [[nodiscard]] std::vector<Body> bodies_at(double t_s) const;
};

/// The room, the furniture and the person as seen by a Kinect at 1.05 m tilted down 3 degrees; both
/// cameras of the given size, the colour camera with an own matrix and mild distortion.
[[nodiscard]] SyntheticScene make_scene(Motion motion, int width = 640, int height = 480);

/// Refuses invalid rigs, poses that are not rigid or not finite, non-finite solids.
[[nodiscard]] Result<void> validate(const SyntheticScene& scene);

/// First solid on the ray origin + t * direction with t in (0, t_max): its t, else t_max. Double,
/// one ray: for joints and probes, not for pictures.
[[nodiscard]] double first_hit(std::span<const Primitive> solids, const glm::dvec3& origin,
                               const glm::dvec3& direction, double t_max);

}  // namespace kino
