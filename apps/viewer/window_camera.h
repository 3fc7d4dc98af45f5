#pragma once

#include <optional>

#include "base/body.h"
#include "skeleton/head/window_eye.h"
#include "viz/frame/renderer.h"
#include "viz/scene/scene_file.h"
#include "viz/scene/view.h"

namespace kino {

/// The camera of a scene whose screen is a window: the nearest person's head leads it.
class WindowCamera {
  public:
    explicit WindowCamera(const SceneWindow& window);

    /// The people of a depth frame, seen at `time`; the clock of all other times here.
    void see(TimeNs time, const BodyFrame* bodies);
    /// What the eye sees that is expected at `time`.
    [[nodiscard]] View view(const Pose& world_from_stage, TimeNs time, int width, int height) const;
    /// How a picture of `width` is brought to the pose of the moment it is copied at, `clock()`
    /// then; empty where the scene wants none, or the eye is at rest and nothing would move.
    [[nodiscard]] std::optional<DeflectOptions> deflection(const Pose& world_from_stage, TimeNs now,
                                                           int width, int height,
                                                           TimeNs (*clock)()) const;
    /// Velocity of the eye; 0 while nobody is followed.
    [[nodiscard]] glm::dvec3 head_m_s(TimeNs now) const { return eye_.velocity_m_s(now); }
    /// Another source: whoever was followed is gone.
    void reset() { eye_.reset(); }
    [[nodiscard]] const WindowEye& eye() const { return eye_; }

  private:
    SceneWindow window_;
    WindowEye eye_;
};

}  // namespace kino
