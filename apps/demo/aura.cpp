#include "apps/demo/aura.h"

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

constexpr double kFadeS = 0.5, kPlayS = 0.4, kSwellS = 0.6;
constexpr double kWatching = 0.013, kPlaying = 0.024, kSwelling = 1.8;
constexpr float kRadiusM = 0.8f;
constexpr double kLeastLight = 1.0 / 256;
/// Before the body, in stage axes, so that it lights what the camera sees.
constexpr glm::dvec3 kOffM{0, 0.05, 0.3};

}  // namespace

void Aura::step(double dt_s, std::span<const CastMember> cast, const Players& players) {
    for (std::size_t i = 0; i < places_.size() && i < cast.size(); ++i) {
        const CastMember& member = cast[i];
        OfPlace& place = places_[i];
        if (place.id != member.id) place = {.id = member.id};
        const int painter = players.place_of(member.id);
        if (painter >= 0) place.painter = painter;
        approach(place.playing, painter >= 0 ? 1 : 0, dt_s, kPlayS);
        place.swell = std::max(0.0, place.swell - dt_s / kSwellS);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const bool on = member.present && member.joints[j].seen;
            if (!member.joints[j].known) place.presence[j] = 0;
            approach(place.presence[j], on ? 1 : 0, dt_s, kFadeS);
        }
    }
}

void Aura::swell(std::uint32_t id) {
    for (OfPlace& place : places_) {
        if (id != 0 && place.id == id) place.swell = 1;
    }
}

std::size_t Aura::lights(std::span<const CastMember> cast) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < places_.size() && i < cast.size(); ++i) {
        for (std::size_t j = 0; j < kJointCount; ++j) {
            count += smooth(places_[i].presence[j]) >= kLeastLight;
        }
    }
    return count;
}

void Aura::fill(Scene& scene, std::span<const CastMember> cast, std::span<const Colors> colors,
                const Pose& world_from_stage) const {
    for (std::size_t i = 0; i < places_.size() && i < cast.size(); ++i) {
        const OfPlace& place = places_[i];
        const auto painter = static_cast<std::size_t>(place.painter);
        const double strength = (kWatching + (kPlaying - kWatching) * place.playing) *
                                (1 + kSwelling * smooth(place.swell));
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const double weight = smooth(place.presence[j]);
            if (weight < kLeastLight) continue;
            const glm::vec3 white(1.0f, 0.86f, 0.72f);
            const glm::vec3 color =
                glm::mix(white, colors[painter].at(j), static_cast<float>(place.playing));
            scene.lights.push_back(
                {.kind = LightKind::point,
                 .position = cast[i].joints[j].world_m + world_from_stage.rotation * kOffM,
                 .color = color * static_cast<float>(strength * weight),
                 .radius_m = kRadiusM});
        }
    }
}

}  // namespace kino::demo
