#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "apps/viewer/scene_place.h"
#include "base/camera_model.h"
#include "viz/scene/view.h"

namespace kino {

enum class ViewKind : std::uint8_t { sensor, orbit, fly };
[[nodiscard]] const char* view_name(ViewKind kind);

/// Turns around a point, up is up. Sways gently until it is touched.
class OrbitCamera {
  public:
    /// Starts about where the depth camera stands, looking at the centre.
    void reset(const ScenePlace& place);
    /// Radians; to the right and upwards.
    void turn(double yaw, double pitch);
    /// Moves the centre in the picture plane, in parts of the distance.
    void pan(glm::dvec2 right_up);
    void zoom(double factor);
    /// Follows a centre that wanders (a camera carried through rooms), `dt_s` later.
    void follow(const glm::dvec3& center, double dt_s);
    /// Now, by any clock that does not jump: where the sway is.
    void set_time(double time_s) { time_s_ = time_s; }
    /// Stays where it is from here on, as after a touch.
    void hold_still();
    [[nodiscard]] Pose pose() const;
    [[nodiscard]] bool sways() const { return !touched_; }

  private:
    glm::dvec3 target_{0};
    double distance_m_ = 2;
    struct Angles {
        double yaw = 0;
        double pitch = 0;
    };
    [[nodiscard]] Angles swayed() const;
    double yaw_ = 0;
    double pitch_ = 0;
    double time_s_ = 0;
    bool touched_ = false;
};

/// Free flight, up is up.
class FlyCamera {
  public:
    void reset(const Pose& world_from_view);
    void look(double yaw, double pitch);
    /// Metres along the camera's right, the world's up, and forward.
    void move(const glm::dvec3& right_up_forward);
    [[nodiscard]] Pose pose() const;

  private:
    [[nodiscard]] glm::dvec3 forward() const;
    glm::dvec3 position_{0};
    double yaw_ = 0;
    double pitch_ = 0;
};

/// The camera the user steers, of whichever kind.
struct CameraControl {
    ViewKind kind = ViewKind::orbit;
    OrbitCamera orbit;
    FlyCamera fly;

    void reset(const ScenePlace& place);
    /// Changes the kind; flight starts where the last picture was seen from.
    void choose(ViewKind wanted, const Pose& world_from_view);
    /// `depth` and `world_from_depth` are those of the frame shown.
    [[nodiscard]] View view(const CameraModel& depth, const Pose& world_from_depth, int width,
                            int height) const;
};

}  // namespace kino
