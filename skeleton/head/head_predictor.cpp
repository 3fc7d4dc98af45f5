#include "skeleton/head/head_predictor.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

/// Before the second measurement the head may move as fast as heads do.
constexpr double kSeedSpeedM2S2 = 1;

bool is_number(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

void HeadPredictor::seed(TimeNs time, const glm::dvec3& position_m, double variance) {
    for (int i = 0; i < 3; ++i) {
        axes_[static_cast<std::size_t>(i)] = {
            .p = position_m[i], .pp = variance, .vv = kSeedSpeedM2S2};
    }
    time_ = last_seen_ = time;
    refused_ = 0;
    seeded_ = true;
}

HeadMeasurement HeadPredictor::measure(TimeNs time, const glm::dvec3& position_m, double depth_m) {
    if (!is_number(position_m) || !std::isfinite(depth_m)) return HeadMeasurement::skipped;
    const double sigma = options_.near_sigma_m + options_.depth_sigma * depth_m * depth_m;
    const double variance = sigma * sigma;
    if (!seeded_ || time - last_seen_ > options_.longest_gap) {
        seed(time, position_m, variance);
        return HeadMeasurement::seeded;
    }
    if (time <= last_seen_) return HeadMeasurement::skipped;
    last_seen_ = time;

    const double dt = to_seconds(time - time_);
    const double q = options_.noise_m2_s3;
    std::array<Axis, 3> predicted = axes_;
    double off = 0;  // squared, in standard deviations
    for (std::size_t i = 0; i < 3; ++i) {
        Axis& a = predicted[i];
        a.p += a.v * dt;
        a.pp += dt * (2 * a.pv + dt * a.vv) + q * dt * dt * dt / 3;
        a.pv += dt * a.vv + q * dt * dt / 2;
        a.vv += q * dt;
        const double innovation = position_m[static_cast<int>(i)] - a.p;
        off = std::max(off, innovation * innovation / (a.pp + variance));
    }
    if (off > options_.gate_sigmas * options_.gate_sigmas) {
        if (++refused_ < options_.reseed_after) return HeadMeasurement::refused;
        seed(time, position_m, variance);
        return HeadMeasurement::seeded;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        Axis& a = predicted[i];
        const double gain_p = a.pp / (a.pp + variance);
        const double gain_v = a.pv / (a.pp + variance);
        const double innovation = position_m[static_cast<int>(i)] - a.p;
        a.p += gain_p * innovation;
        a.v += gain_v * innovation;
        a.vv -= gain_v * a.pv;
        a.pv *= 1 - gain_p;
        a.pp *= 1 - gain_p;
    }
    axes_ = predicted;
    time_ = time;
    refused_ = 0;
    return HeadMeasurement::taken;
}

glm::dvec3 HeadPredictor::velocity_m_s() const {
    if (!seeded_) return glm::dvec3(0);
    const glm::dvec3 v{axes_[0].v, axes_[1].v, axes_[2].v};
    const double speed = glm::length(v);
    return speed > options_.fastest_m_s ? v * (options_.fastest_m_s / speed) : v;
}

std::optional<glm::dvec3> HeadPredictor::at(TimeNs time) const {
    if (!seeded_) return std::nullopt;
    const double ahead = to_seconds(std::clamp<TimeNs>(time - time_, 0, options_.farthest));
    return glm::dvec3{axes_[0].p, axes_[1].p, axes_[2].p} + ahead * velocity_m_s();
}

bool HeadPredictor::lost(TimeNs time) const {
    return !seeded_ || time - time_ > options_.longest_gap;
}

}  // namespace kino
