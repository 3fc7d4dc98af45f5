#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "base/body.h"
#include "base/pose.h"
#include "skeleton/head/head_predictor.h"

namespace kino {

struct WindowEyeOptions {
    /// Window space: origin in the screen's centre, x to the viewer's right, y up, z to the viewer.
    Pose screen_from_sensor;
    glm::dvec3 default_eye_m{0, 0, 0.6};  ///< window space; where nobody is seen
    double eye_before_head_m = 0.08;    ///< eyes are that much nearer to the screen than the joint
    double nearest_hysteresis_m = 0.3;  ///< another viewer must be nearer by that much
    TimeNs ease = kNsPerSecond;         ///< from a lost head to the default eye
    HeadPredictorOptions predictor;
};

/// The eye that a screen used as a window is seen with: the nearest person's, predicted; the
/// default one, reached smoothly, where there is nobody.
class WindowEye {
  public:
    explicit WindowEye(const WindowEyeOptions& options)
        : options_(options), predictor_(options.predictor) {}

    /// The people that a depth frame of `time` shows, in depth-camera space.
    void see(TimeNs time, std::span<const Body> bodies);
    /// The eye at `time`, window space; always a number.
    [[nodiscard]] glm::dvec3 at(TimeNs time) const;
    /// m/s; 0 while nobody is followed.
    [[nodiscard]] glm::dvec3 velocity_m_s(TimeNs time) const;
    [[nodiscard]] std::uint32_t followed() const { return followed_; }  ///< Body::id; 0: nobody
    void reset();

  private:
    [[nodiscard]] glm::dvec3 eased(TimeNs time) const;

    WindowEyeOptions options_;
    HeadPredictor predictor_;
    std::uint32_t followed_ = 0;
    /// Where the eye was when a head was found, and when: it is taken over as smoothly as lost.
    glm::dvec3 found_at_m_{0};
    TimeNs found_time_ = 0;
    bool found_ = false;
};

}  // namespace kino
