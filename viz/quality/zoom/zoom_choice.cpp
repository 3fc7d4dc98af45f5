#include "viz/quality/zoom/zoom_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {
namespace {

/// A zoom in use is kept until it saves less than this part of what it must save to be taken.
constexpr double kStillSaves = 0.75;

}  // namespace

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

ZoomChoice ZoomRelease::smallest(std::span<const double> ms) const {
    // A hair above the target is the target.
    const double target = rules_.target_ms * (1 + 1e-9);
    const auto in_time = std::find_if(ms.begin(), ms.end(), [&](double t) { return t <= target; });
    const double least = rules_.least_saving * ms[0];
    if (in_time != ms.end()) {
        const bool pays = ms[0] - *in_time >= least;
        const bool wanted = pays || rules_.least_saving <= 0;
        return {.z = wanted ? 1 + static_cast<int>(in_time - ms.begin()) : 1};
    }
    std::size_t step = 0;
    while (step + 1 < ms.size() && (rules_.least_saving <= 0 || ms[step] - ms[step + 1] >= least)) {
        ++step;
    }
    return {.z = 1 + static_cast<int>(step), .unreachable = true};
}

ZoomChoice ZoomRelease::choose(std::span<const double> ms) {
    KINO_CHECK_EQ(ms.size(), static_cast<std::size_t>(rules_.most));
    ZoomChoice choice = smallest(ms);
    const auto z = static_cast<std::size_t>(z_);
    double below_ms = ms[std::max<std::size_t>(z, 2) - 2];
    if (z > 1 && choice.z < z_ && rules_.least_saving > 0) {
        const bool reaches = ms[z - 1] <= rules_.target_ms && below_ms > rules_.target_ms;
        const double saves = reaches ? ms[0] - ms[z - 1] : below_ms - ms[z - 1];
        // What pays no longer is let go as what is no longer needed.
        if (saves < kStillSaves * rules_.least_saving * ms[0]) below_ms = 0;
    }
    choice.z = follow(choice.z, below_ms);
    return choice;
}

void ReactiveZoom::reset() {
    release_.reset();
    choice_ = {};
}

ZoomChoice ReactiveZoom::frame_took(double frame_ms, double pixel_ms, double copy_ms) {
    if (!(frame_ms >= 0) || !(pixel_ms >= 0) || !std::isfinite(frame_ms)) return choice_;
    const int z = choice_.z;
    const double pixels = std::min(pixel_ms, frame_ms);
    const double copy = copy_ms >= 0 && std::isfinite(copy_ms) ? copy_ms : 0;
    const double rest = std::max(0.0, frame_ms - pixels - (z > 1 ? copy : 0));
    const double at_one = pixels * z * z;
    std::array<double, kMaxZoom> ms{};
    for (int i = 1; i <= rules_.most; ++i) {
        ms[static_cast<std::size_t>(i - 1)] = rest + at_one / (i * i) + (i > 1 ? copy : 0);
    }
    choice_ = release_.choose(std::span(ms).first(static_cast<std::size_t>(rules_.most)));
    // With nothing left for pixels, none would be in time.
    choice_.unreachable = choice_.unreachable || !(rest < rules_.target_ms);
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
