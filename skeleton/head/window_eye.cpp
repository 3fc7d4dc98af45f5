#include "skeleton/head/window_eye.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

namespace kino {
namespace {

double smooth_part(TimeNs since, TimeNs whole) {
    if (whole <= 0) return 1;
    const double x = std::clamp(to_seconds(since) / to_seconds(whole), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

}  // namespace

void WindowEye::reset() {
    predictor_.reset();
    followed_ = 0;
    found_ = false;
}

void WindowEye::see(TimeNs time, std::span<const Body> bodies) {
    struct Seen {
        std::uint32_t id;
        glm::dvec3 head_m;  ///< window space
        double depth_m;     ///< from the sensor
        double distance_m;  ///< from the screen's centre
    };
    std::optional<Seen> nearest, same;
    for (const Body& body : bodies) {
        const JointPosition& head = body[Joint::head];
        if (head.state == JointState::lost) continue;
        const glm::dvec3 at = options_.screen_from_sensor * glm::dvec3(head.position_m);
        const Seen seen{body.id, at, head.position_m.z, glm::length(at)};
        if (!(seen.distance_m < 100)) continue;  // not a number, or not a place
        if (!nearest || seen.distance_m < nearest->distance_m) nearest = seen;
        if (found_ && body.id == followed_) same = seen;
    }
    if (!nearest) return;
    const bool stays =
        same && same->distance_m - nearest->distance_m <= options_.nearest_hysteresis_m;
    const Seen& chosen = stays ? *same : *nearest;
    if (!stays || predictor_.lost(time)) {
        found_at_m_ = at(time);
        found_time_ = time;
        predictor_.reset();
        followed_ = chosen.id;
        found_ = true;
    }
    predictor_.measure(time, chosen.head_m, chosen.depth_m);
}

glm::dvec3 WindowEye::eased(TimeNs time) const {
    const glm::dvec3 eye = predictor_.at(time).value_or(options_.default_eye_m) -
                           glm::dvec3(0, 0, options_.eye_before_head_m);
    return glm::mix(found_at_m_, eye, smooth_part(time - found_time_, options_.ease));
}

glm::dvec3 WindowEye::at(TimeNs time) const {
    if (!found_) return options_.default_eye_m;
    const TimeNs lost = predictor_.last_time() + options_.predictor.longest_gap;
    if (time <= lost) return eased(time);
    return glm::mix(eased(lost), options_.default_eye_m, smooth_part(time - lost, options_.ease));
}

glm::dvec3 WindowEye::velocity_m_s(TimeNs time) const {
    return !found_ || predictor_.lost(time) ? glm::dvec3(0) : predictor_.velocity_m_s();
}

}  // namespace kino
