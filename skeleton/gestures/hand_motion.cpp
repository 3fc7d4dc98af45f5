#include "skeleton/gestures/hand_motion.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace kino {

std::optional<HandSample> HandMotion::add(double time_s, const glm::dvec3& at, double smoothing_s) {
    raw_.push_back({time_s, at});
    while (raw_.front().time_s <= time_s - smoothing_s) raw_.pop_front();
    if (raw_.size() < 2 || time_s - raw_.front().time_s < smoothing_s * 0.4) return std::nullopt;
    const auto count = static_cast<double>(raw_.size());
    HandSample out;
    for (const Raw& r : raw_) {
        out.time_s += r.time_s / count;
        out.place += r.at / count;
    }
    double spread = 0;
    for (const Raw& r : raw_) {
        const double t = r.time_s - out.time_s;
        spread += t * t;
        out.speed_per_s += t * (r.at - out.place);
    }
    out.speed_per_s /= spread;
    return out;
}

std::optional<Stroke> HandMotion::cut(const HandSample& sample,
                                      const StrokeDefinition& definition) {
    const double speed = glm::length(sample.speed_per_s);
    if (!stroke_) {
        if (speed > definition.start_speed_per_s) {
            const bool rested = rest_ && sample.time_s - rest_->time_s < 0.3;
            const HandSample from = rested ? *rest_ : sample;
            stroke_ = Stroke{from, sample, speed, glm::min(from.place, sample.place),
                             glm::max(from.place, sample.place)};
        } else if (speed < definition.stop_speed_per_s) {
            rest_ = sample;
        }
        return std::nullopt;
    }
    const glm::dvec3 way = stroke_->to.place - stroke_->from.place;
    const bool back = glm::length(way) > 0.15 && glm::dot(sample.speed_per_s, way) < 0;
    stroke_->to = sample;
    stroke_->low = glm::min(stroke_->low, sample.place);
    stroke_->high = glm::max(stroke_->high, sample.place);
    stroke_->peak_speed_per_s = std::max(stroke_->peak_speed_per_s, speed);
    if (speed >= definition.stop_speed_per_s && !back) return std::nullopt;
    const Stroke done = *stroke_;
    stroke_.reset();
    rest_ = sample;
    return done;
}

}  // namespace kino
