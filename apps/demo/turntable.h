#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "apps/demo/solid.h"
#include "base/pose.h"
#include "skeleton/gestures/gesture_event.h"
#include "viz/scene/scene_file.h"

namespace kino::demo {

/// From where the stage is seen: turned about the player and nearer or farther by two hands, within
/// limits; going round slowly by itself while nobody is there.
class Turntable {
  public:
    static constexpr double kMostYawRad = 0.95;  ///< the depth mesh of a person has no back
    static constexpr double kLeastZoom = 0.55, kMostZoom = 1.7;  ///< of the scene's own distance

    void reset() { *this = {}; }
    /// Zoom and rotate of the primary user. `mirror`: the stage turns as seen in a mirror.
    void hear(const GestureEvent& event, bool mirror);
    /// Who turned it is gone.
    void let_go();
    /// Back to where the scene has it, over a second.
    void straighten();
    /// What the camera must not stand in, nor have between it and its target.
    struct Around {
        const SceneCamera& camera;
        const RoomBox& room;
        const std::vector<Solid>& solids;
    };
    /// `pivot_m`: stage; where the player is. `nobody`: it goes round by itself.
    void step(double dt_s, const std::optional<glm::dvec3>& pivot_m, bool nobody,
              const Around& around);
    struct Look {
        glm::dvec3 eye_m{0}, target_m{0};
    };
    /// Stage space; the eye stays in the room and above the floor.
    [[nodiscard]] Look look(const SceneCamera& camera, const RoomBox& room) const;
    [[nodiscard]] double yaw_rad() const { return yaw_; }
    [[nodiscard]] double zoom() const { return zoom_; }
    /// Where it is going.
    [[nodiscard]] double yaw_to_rad() const { return yaw_to_; }
    [[nodiscard]] double zoom_to() const { return zoom_to_; }

  private:
    [[nodiscard]] double wandering_yaw() const;
    [[nodiscard]] Look look_at_yaw(double yaw_rad, const SceneCamera& camera,
                                   const RoomBox& room) const;
    [[nodiscard]] double free_part(double yaw_rad, const Around& around) const;

    double yaw_ = 0, yaw_to_ = 0, yaw_from_ = 0;
    double zoom_ = 1, zoom_to_ = 1, zoom_from_ = 1;
    double time_s_ = 0;
    double alone_ = 0;  ///< 1: goes round by itself
    double ease_s_ = 0.1;
    double part_ = 1;  ///< of the way back that the eye goes, for what stands in it
    glm::dvec3 pivot_{0};
};

}  // namespace kino::demo
