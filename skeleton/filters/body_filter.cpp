#include "skeleton/filters/body_filter.h"

#include <algorithm>
#include <cmath>

#include "skeleton/filters/holt_filter.h"
#include "skeleton/filters/kalman_filter.h"
#include "skeleton/filters/one_euro_filter.h"

namespace kino {

bool BodyFilter::usable(const JointPosition& joint) const {
    const auto within = [&](float v) { return std::abs(v) <= gate_.max_distance_m; };  // NaN: no
    return joint.state != JointState::lost && within(joint.position_m.x) &&
           within(joint.position_m.y) && within(joint.position_m.z);
}

void BodyFilter::coast(std::size_t j, TimeNs time) {
    JointPosition& out = last_.joints[j];
    out.state = JointState::lost;
    out.confidence = 0;
    if (!live_[j]) return;
    const double gap_s = to_seconds(time - seen_[j]);
    if (gap_s > gate_.max_gap_s) {
        live_[j] = false;
        return;
    }
    out.position_m = ahead(j, std::min(gap_s, gate_.max_prediction_s));
}

Body BodyFilter::update(const Body& measured, TimeNs time) {
    if (started_ && time == time_ && measured.id == last_.id) return last_;
    if (!started_ || time < time_ || measured.id != last_.id) {
        live_.fill(false);
        last_ = Body{};
    }
    started_ = true;
    time_ = time;
    last_.id = measured.id;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const JointPosition& in = measured.joints[j];
        if (!usable(in)) {
            coast(j, time);
            continue;
        }
        const double dt_s = to_seconds(time - seen_[j]);
        JointPosition& out = last_.joints[j];
        if (!live_[j] || dt_s > gate_.max_gap_s) {
            start(j, in.position_m);
            out.position_m = in.position_m;
        } else {
            out.position_m = step(j, in.position_m, in.state == JointState::inferred, dt_s);
        }
        live_[j] = true;
        seen_[j] = time;
        out.state = in.state;
        out.confidence = std::isfinite(in.confidence) ? std::clamp(in.confidence, 0.f, 1.f) : 0;
    }
    return last_;
}

Body BodyFilter::predict(TimeNs time) const {
    if (!started_) return {};
    Body out = last_;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        if (!live_[j]) continue;
        const double ahead_s = to_seconds(std::max(time, time_) - seen_[j]);
        out.joints[j].position_m = ahead(j, std::min(ahead_s, gate_.max_prediction_s));
    }
    return out;
}

Result<std::unique_ptr<BodyFilter>> make_body_filter(std::string_view name) {
    const std::string_view kind = name.substr(0, name.find(':'));
    const std::string_view preset =
        kind.size() == name.size() ? "default" : name.substr(kind.size() + 1);
    if (name == "none") return nullptr;
    if (kind == "holt") {
        if (const auto found = holt_preset(preset)) return std::make_unique<HoltFilter>(*found);
    } else if (kind == "one-euro") {
        if (const auto found = one_euro_preset(preset))
            return std::make_unique<OneEuroFilter>(*found);
    } else if (kind == "kalman") {
        if (const auto found = kalman_preset(preset)) return std::make_unique<KalmanFilter>(*found);
    }
    return fail("there is no joint filter of this name", std::string(name),
                "none, holt:default, holt:somewhat-latent, holt:very-smooth, one-euro:default, "
                "one-euro:calm, one-euro:quick, kalman:default, kalman:calm or kalman:quick");
}

}  // namespace kino
