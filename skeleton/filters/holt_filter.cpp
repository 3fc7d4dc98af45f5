#include "skeleton/filters/holt_filter.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace kino {

std::optional<HoltParameters> holt_preset(std::string_view name) {
    if (name == "default") return HoltParameters{};
    if (name == "somewhat-latent") return HoltParameters{0.5, 0.1, 0.5, 0.1, 0.1};
    if (name == "very-smooth") return HoltParameters{0.7, 0.3, 1.0, 1.0, 1.0};
    return std::nullopt;
}

HoltFilter::HoltFilter(const HoltParameters& parameters)
    : BodyFilter(parameters.gate), parameters_(parameters) {
    KINO_CHECK(parameters.smoothing >= 0 && parameters.smoothing < 1);
    KINO_CHECK(parameters.correction >= 0 && parameters.correction <= 1);
    KINO_CHECK(parameters.prediction >= 0 && parameters.inferred_scale >= 1);
    KINO_CHECK(parameters.jitter_radius_m >= 0 && parameters.max_deviation_m >= 0);
}

void HoltFilter::start(std::size_t j, const glm::dvec3& at) {
    tracks_[j] = {at, glm::dvec3(0), at, 0};
}

glm::dvec3 HoltFilter::step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) {
    Track& track = tracks_[j];
    const double scale = inferred ? parameters_.inferred_scale : 1;
    const double radius_m = parameters_.jitter_radius_m * scale;
    const double moved_m = glm::distance(at, track.level);
    const glm::dvec3 calmed =
        moved_m < radius_m ? glm::mix(track.level, at, moved_m / radius_m) : at;

    const glm::dvec3 before = track.level;
    track.level = glm::mix(calmed, before + track.trend, parameters_.smoothing);
    track.trend = glm::mix(track.trend, track.level - before, parameters_.correction);
    track.dt_s = dt_s;

    track.result = track.level + parameters_.prediction * track.trend;
    const double most_m = parameters_.max_deviation_m * scale;
    const double off_m = glm::distance(track.result, at);
    if (off_m > most_m) track.result = glm::mix(at, track.result, most_m / off_m);
    return track.result;
}

glm::dvec3 HoltFilter::ahead(std::size_t j, double ahead_s) const {
    const Track& track = tracks_[j];
    if (track.dt_s <= 0) return track.result;
    return track.result + track.trend * (ahead_s / track.dt_s);
}

}  // namespace kino
