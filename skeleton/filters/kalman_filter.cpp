#include "skeleton/filters/kalman_filter.h"

#include <cmath>

#include "base/check.h"

namespace kino {
namespace {
constexpr double kReferenceRateHz = 30;
}

std::optional<KalmanParameters> kalman_preset(std::string_view name) {
    if (name == "default") return KalmanParameters{};
    if (name == "calm") return KalmanParameters{1.0, 0.02};
    if (name == "quick") return KalmanParameters{20.0, 0.012};
    return std::nullopt;
}

KalmanFilter::KalmanFilter(const KalmanParameters& parameters)
    : BodyFilter(parameters.gate), parameters_(parameters) {
    KINO_CHECK(parameters.acceleration_density > 0 && parameters.noise_m > 0);
    KINO_CHECK(parameters.inferred_noise_scale >= 1 && parameters.start_speed_sigma_mps >= 0);
}

KalmanFilter::Track KalmanFilter::moved(const Track& track, double dt_s) const {
    const double q = parameters_.acceleration_density;
    Track out = track;
    out.position_m += track.velocity_mps * dt_s;
    out.pp += dt_s * (2 * track.pv + dt_s * (track.vv + q * dt_s / 3));
    out.pv += dt_s * (track.vv + q * dt_s / 2);
    out.vv += q * dt_s;
    return out;
}

void KalmanFilter::start(std::size_t j, const glm::dvec3& at) {
    const double noise_m = parameters_.noise_m, speed = parameters_.start_speed_sigma_mps;
    tracks_[j] = {at, glm::dvec3(0), noise_m * noise_m, 0, speed * speed};
}

glm::dvec3 KalmanFilter::step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) {
    Track& track = tracks_[j];
    track = moved(track, dt_s);
    const double noise_m = parameters_.noise_m * (inferred ? parameters_.inferred_noise_scale : 1);
    const double r = noise_m * noise_m / (kReferenceRateHz * dt_s);
    const double gain_p = track.pp / (track.pp + r), gain_v = track.pv / (track.pp + r);
    const glm::dvec3 surprise = at - track.position_m;
    track.position_m += gain_p * surprise;
    track.velocity_mps += gain_v * surprise;
    // In this order: each line reads what the next one changes.
    track.vv -= gain_v * track.pv;
    track.pv *= 1 - gain_p;
    track.pp *= 1 - gain_p;
    return track.position_m;
}

glm::dvec3 KalmanFilter::ahead(std::size_t j, double ahead_s) const {
    return tracks_[j].position_m + tracks_[j].velocity_mps * ahead_s;
}

double KalmanFilter::sigma_m(Joint j, double ahead_s) const {
    return std::sqrt(moved(tracks_[static_cast<std::size_t>(j)], ahead_s).pp);
}

}  // namespace kino
