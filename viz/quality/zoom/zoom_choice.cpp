#include "viz/quality/zoom/zoom_choice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {

int ZoomRelease::follow(int wanted, double below_ms) {
    wanted = std::clamp(wanted, 1, rules_.most);
    if (wanted >= z_) {
        if (wanted > z_) calm_frames_ = 0;
        z_ = wanted;
    }
    const bool calm = z_ > 1 && wanted <= z_ && below_ms < rules_.release_part * rules_.target_ms;
    calm_frames_ = calm ? calm_frames_ + 1 : 0;
    if (calm_frames_ >= rules_.release_frames) {
        --z_;
        calm_frames_ = 0;
    }
    return z_;
}

void ReactiveZoom::reset() {
    release_.reset();
    choice_ = {};
}

ZoomChoice ReactiveZoom::frame_took(double frame_ms, double pixel_ms) {
    if (!(frame_ms >= 0) || !(pixel_ms >= 0) || !std::isfinite(frame_ms)) return choice_;
    const int z = choice_.z;
    const double pixels = std::min(pixel_ms, frame_ms);
    const double rest = frame_ms - pixels;
    const double at_one = pixels * z * z;
    const double room = rules_.target_ms - rest;
    choice_.unreachable = !(room > 0) || at_one > room * rules_.most * rules_.most;
    int wanted = rules_.most;
    if (!choice_.unreachable) {
        // A hair above a whole number is that number.
        wanted = std::max(1, static_cast<int>(std::ceil(std::sqrt(at_one / room) - 1e-9)));
    }
    const int below = std::max(z - 1, 1);
    choice_.z = release_.follow(wanted, rest + at_one / (below * below));
    return choice_;
}

int HeadSpeedZoom::step(double dt_s, const glm::dvec3& velocity_m_s, double turn_deg_s) {
    const auto number = [](double v) { return std::isfinite(v) ? std::abs(v) : 0.0; };
    const double now = number(turn_deg_s) / options_.turn_deg_s +
                       number(glm::length(velocity_m_s)) / options_.move_m_s;
    const double faded = steps_ * std::exp(-std::max(number(dt_s), 0.0) / options_.release_s);
    steps_ = std::max(now, faded);
    z_ = std::clamp(1 + static_cast<int>(std::min(std::floor(steps_), 100.0)), 1, options_.most);
    return z_;
}

double frame_interval_ms(double frame_ms, double refresh_hz, FrameSync sync) {
    if (sync == FrameSync::free_running) return frame_ms;
    const double retrace_ms = 1000 / refresh_hz;
    return std::max(1.0, std::ceil(frame_ms / retrace_ms - 1e-9)) * retrace_ms;
}

}  // namespace kino
