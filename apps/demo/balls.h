#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "apps/demo/solid.h"

namespace kino::demo {

struct Ball {
    glm::dvec3 at_m{0}, speed_m_s{0};  ///< stage
    glm::dvec3 shown_m{0};             ///< where it was drawn last
    double age_s = 0;
    double flash = 0;   ///< 1 when it hits, 0 a moment later
    int painter = 0;    ///< whose colours it has
    double rounds = 0;  ///< through the palette
    std::uint64_t number = 0;
};

struct BallRules {
    double gravity_m_s2 = 9.81;
    double restitution = 0.74;
    double rolling_per_s = 0.55;  ///< part of the speed along the ground that is lost
    double grip = 0.06;           ///< part of the speed along a wall that a bounce takes
    double radius_m = 0.06;
    double life_s = 8;
    double fade_s = 0.8;  ///< of life, at its end
    double fastest_m_s = 12;
    std::size_t most = 48;  ///< a new one takes the place of the oldest
};

/// Balls that fly, bounce off solids and each other, roll, rest and fade. Steps of 1/240 s each,
/// whatever the moments: where a moment is cut changes nothing but when its end is seen. Flight is
/// exact; where a step ends inside a solid, the speed is brought to what it was at its surface
/// (v^2 changes by 2 g.d), so energy is kept by an elastic bounce and never grows.
class Balls {
  public:
    static constexpr double kStepS = 1.0 / 240;

    explicit Balls(const BallRules& rules = {}) : rules_(rules) {}

    void set_solids(std::vector<Solid> solids) { solids_ = std::move(solids); }
    /// False, and nothing is thrown, where something is not finite.
    bool throw_ball(const glm::dvec3& at_m, const glm::dvec3& speed_m_s, int painter,
                    double rounds);
    void step(double dt_s);
    void clear();
    void shown();  ///< they were drawn where they are

    [[nodiscard]] const std::vector<Ball>& all() const { return balls_; }
    [[nodiscard]] std::vector<Ball>& all() { return balls_; }
    [[nodiscard]] const BallRules& rules() const { return rules_; }
    [[nodiscard]] std::uint64_t thrown() const { return thrown_; }
    /// 0 .. 1 of its light.
    [[nodiscard]] double weight(const Ball& ball) const;
    /// Kinetic and potential, J for balls of 1 kg.
    [[nodiscard]] double energy() const;

  private:
    void move(Ball& ball);
    void meet();
    void bounce(Ball& ball);

    BallRules rules_;
    std::vector<Solid> solids_;
    std::vector<Ball> balls_;
    double left_s_ = 0;  ///< of moments, not yet stepped
    std::uint64_t thrown_ = 0;
};

}  // namespace kino::demo
