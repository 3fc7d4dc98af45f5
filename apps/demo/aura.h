#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "apps/demo/palettes.h"
#include "apps/demo/players.h"
#include "base/pose.h"
#include "viz/scene/scene.h"

namespace kino::demo {

/// Soft lights at the joints of everybody: white of those who only watch, in their colours of those
/// who play. They swell for a moment when a gesture was understood.
class Aura {
  public:
    void reset() { *this = {}; }
    void step(double dt_s, std::span<const CastMember> cast, const Players& players);
    void swell(std::uint32_t id);
    [[nodiscard]] std::size_t lights(std::span<const CastMember> cast) const;
    /// Appends at most as many lights as there are joints in the cast.
    void fill(Scene& scene, std::span<const CastMember> cast, std::span<const Colors> colors,
              const Pose& world_from_stage) const;

  private:
    struct OfPlace {
        std::uint32_t id = 0;
        double playing = 0;  ///< 0 watches .. 1 plays
        double swell = 0;
        std::array<double, kJointCount> presence{};
        int painter = 0;
    };
    std::array<OfPlace, Cast::kPlaces> places_{};
};

}  // namespace kino::demo
