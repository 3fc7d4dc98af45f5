#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "apps/stage/cast.h"

namespace kino::demo {

/// Where the hands of everybody were of late, so that a push knows its direction. World space.
class Throws {
  public:
    static constexpr double kLeastM_s = 3.2, kMostM_s = 8;

    void reset() { *this = {}; }
    void step(double dt_s, std::span<const CastMember> cast);
    struct Thrown {
        glm::dvec3 from_m{0}, speed_m_s{0};
    };
    /// Of a push that took so long: along the hand's way, faster than the hand, a little upwards.
    /// A hand that was not seen moving throws along `ahead` (unit length). Empty for who was not
    /// seen, or whose hand never was.
    [[nodiscard]] std::optional<Thrown> of(std::uint32_t id, Joint hand, double took_s,
                                           const glm::dvec3& ahead) const;

  private:
    static constexpr std::size_t kSamples = 64;
    static constexpr double kApartS = 0.012;
    struct Path {
        std::array<std::pair<double, glm::dvec3>, kSamples> samples{};
        std::size_t count = 0;
    };
    struct OfPlace {
        std::uint32_t id = 0;
        std::array<Path, 2> hands{};
        std::array<glm::dvec3, 2> now{};
        std::array<bool, 2> known{};
    };
    std::array<OfPlace, Cast::kPlaces> places_{};
    double time_s_ = 0;
};

}  // namespace kino::demo
