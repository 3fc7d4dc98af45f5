#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <span>

#include "apps/demo/palettes.h"
#include "apps/demo/players.h"
#include "apps/stage/chance.h"
#include "apps/stage/trail.h"
#include "viz/scene/scene.h"

namespace kino::demo {

/// Points of light that fly off and go out.
struct Spark {
    glm::dvec3 at_m{0}, speed_m_s{0}, shown_m{0};  ///< world
    double age_s = 1e9, life_s = 0.6, rounds = 0;
    int painter = 0;
};

/// What is painted in the air: a trail behind each hand of each player, and what they burst into.
/// World space.
class Painter {
  public:
    static constexpr std::size_t kTrailLights = 200;  ///< a hand
    static constexpr std::size_t kSparks = 1024;
    static constexpr double kLifeS = 9, kBurstS = 0.6;
    /// Ids of its nodes are from its first to below this many more.
    static constexpr std::uint32_t kIds =
        static_cast<std::uint32_t>(2 * Players::kMost * kTrailLights + kSparks);

    explicit Painter(std::uint64_t seed);

    void reset();
    void step(double dt_s, const Players& players, std::span<const CastMember> cast,
              const glm::dvec3& off_m);
    /// Everything painted by one player (-1: everybody) flies off from `from_m`. How many did.
    std::size_t burst(int painter, const glm::dvec3& from_m);
    /// Some sparks from one point: of no consequence, for joy.
    void spray(int painter, const glm::dvec3& from_m, std::size_t count);
    /// Length of what a player has painted so far, m.
    [[nodiscard]] double painted_m(int painter) const { return painted_m_.at(painter); }
    [[nodiscard]] std::size_t lights() const;
    [[nodiscard]] std::size_t points() const;

    /// Appends. `glow` gives the first of kPaletteColors materials of each player.
    void fill(Scene& scene, std::uint32_t first_id, std::span<const Colors> colors,
              std::span<const std::uint32_t> glow) const;
    void shown();

  private:
    void add_spark(const Spark& spark);

    std::array<Trail, 2 * Players::kMost> trails_;
    std::array<double, Players::kMost> painted_m_{};
    std::array<Spark, kSparks> sparks_;
    std::size_t next_spark_ = 0;
    Chance chance_;
    std::uint64_t seed_;
    double time_s_ = 0;
    std::shared_ptr<const MeshAsset> stroke_, bead_;
};

}  // namespace kino::demo
