#pragma once

#include "apps/viewer/camera_control.h"
#include "viz/output/window.h"

namespace kino {

/// Turns mouse and held keys into camera movement. Dragging and the wheel take part in whatever
/// kind of view is chosen; the sensor's view cannot be moved.
class Steering {
  public:
    /// `ui_has_mouse`: the pointer belongs to the user interface now. True if the camera moved.
    bool steer(Window& window, const WindowInput& input, bool ui_has_mouse, double dt_s,
               CameraControl& camera);
    /// The left button was pressed and released without being dragged, since the last call.
    [[nodiscard]] bool take_click();

  private:
    int dragging_ = -1;  ///< button, or none
    glm::dvec2 last_{0};
    double dragged_px_ = 0;
    bool clicked_ = false;
};

}  // namespace kino
