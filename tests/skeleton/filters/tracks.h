#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "skeleton/filters/body_filter.h"
#include "skeleton/synthetic/scene.h"
#include "tests/support/random.h"

namespace kino::test {

/// Every joint at the same place.
inline Body body_at(const glm::dvec3& p, JointState state = JointState::tracked) {
    Body body;
    body.id = 1;
    for (JointPosition& joint : body.joints) joint = {glm::vec3(p), state, 1.f};
    return body;
}

/// What the filter makes of hand_right when every joint follows `track` with dt_s between samples.
inline std::vector<glm::dvec3> run(BodyFilter& filter, const std::vector<glm::dvec3>& track,
                                   double dt_s) {
    std::vector<glm::dvec3> out;
    for (std::size_t i = 0; i < track.size(); ++i)
        out.emplace_back(
            filter
                .update(body_at(track[i]),
                        from_seconds(1 + static_cast<double>(i) * dt_s))[Joint::hand_right]
                .position_m);
    return out;
}

template <class At>
std::vector<glm::dvec3> sampled(At at, double seconds, double rate_hz) {
    std::vector<glm::dvec3> out;
    const auto count = static_cast<int>(std::lround(seconds * rate_hz));
    for (int i = 0; i <= count; ++i) out.emplace_back(at(i / rate_hz));
    return out;
}

inline double normal(Random& random) {
    return std::sqrt(-2 * std::log(random.real(1e-12, 1))) *
           std::cos(2 * std::numbers::pi * random.real(0, 1));
}

inline std::vector<glm::dvec3> with_noise(std::vector<glm::dvec3> track, double sigma_m,
                                          std::uint64_t seed) {
    Random random(seed);
    for (glm::dvec3& p : track)
        p += sigma_m * glm::dvec3(normal(random), normal(random), normal(random));
    return track;
}

/// The right hand of the synthetic waver, depth-camera space.
inline std::vector<glm::dvec3> waving_hand(double seconds, double rate_hz) {
    const SyntheticScene scene = make_scene(Motion::wave, 320, 240);
    const Pose depth_from_world = inverse(scene.world_from_depth);
    return sampled(
        [&](double t) {
            return depth_from_world * pose_body(pose_at(Motion::wave, t))[Joint::hand_right];
        },
        seconds, rate_hz);
}

inline const std::vector<const char*>& filter_names() {
    static const std::vector<const char*> names = {
        "holt:default",     "holt:somewhat-latent", "holt:very-smooth",
        "one-euro:default", "one-euro:calm",        "one-euro:quick",
        "kalman:default",   "kalman:calm",          "kalman:quick"};
    return names;
}

}  // namespace kino::test
