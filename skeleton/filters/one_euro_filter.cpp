#include "skeleton/filters/one_euro_filter.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/check.h"

namespace kino {
namespace {

double weight(double cutoff_hz, double dt_s) {
    return -std::expm1(-2 * std::numbers::pi * cutoff_hz * dt_s);
}

}  // namespace

std::optional<OneEuroParameters> one_euro_preset(std::string_view name) {
    if (name == "default") return OneEuroParameters{};
    if (name == "calm") return OneEuroParameters{0.6, 2.0, 1.5};
    if (name == "quick") return OneEuroParameters{2.5, 10.0, 4.0};
    return std::nullopt;
}

OneEuroFilter::OneEuroFilter(const OneEuroParameters& parameters)
    : BodyFilter(parameters.gate), parameters_(parameters) {
    KINO_CHECK(parameters.min_cutoff_hz > 0 && parameters.speed_cutoff_hz > 0);
    KINO_CHECK(parameters.beta_hz_per_mps >= 0 && parameters.inferred_cutoff_scale > 0);
}

void OneEuroFilter::start(std::size_t j, const glm::dvec3& at) {
    tracks_[j] = {at, at, glm::dvec3(0)};
}

glm::dvec3 OneEuroFilter::step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) {
    Track& track = tracks_[j];
    const glm::dvec3 speed_mps = (at - track.raw) / dt_s;
    track.raw = at;
    track.speed_mps =
        glm::mix(track.speed_mps, speed_mps, weight(parameters_.speed_cutoff_hz, dt_s));
    double cutoff_hz =
        parameters_.min_cutoff_hz + parameters_.beta_hz_per_mps * glm::length(track.speed_mps);
    if (inferred) cutoff_hz *= parameters_.inferred_cutoff_scale;
    track.level = glm::mix(track.level, at, weight(cutoff_hz, dt_s));
    return track.level;
}

glm::dvec3 OneEuroFilter::ahead(std::size_t j, double ahead_s) const {
    return tracks_[j].level + tracks_[j].speed_mps * ahead_s;
}

}  // namespace kino
