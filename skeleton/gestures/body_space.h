#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/body.h"

namespace kino {

/// A body in its own measure: origin in the middle of the shoulders, x to the person's left, y from
/// the hips to the shoulders, z where the chest faces, 1 = the length of an arm with its hand. Side
/// 0 is the left, 1 the right.
struct BodyView {
    double time_s = 0;
    double arm_m = 0;
    double turn_rad = 0;    ///< of the chest away from the sensor
    glm::dvec3 trunk_m{0};  ///< the origin, depth-camera space
    glm::dvec3 head{0};
    bool head_seen = false;
    std::array<glm::dvec3, 2> shoulder{}, elbow{}, hand{};
    std::array<bool, 2> arm_seen{};     ///< elbow and hand are there
    std::array<float, 2> confidence{};  ///< the least of elbow and hand
};

/// Learns the arm's length and steadies the axes over time. One object for each person.
class BodySpace {
  public:
    /// Nothing where the trunk is lost (both shoulders, shoulder_center, hip_center) or the joints
    /// make no sense: not finite, shoulders together, shoulders in the hips.
    [[nodiscard]] std::optional<BodyView> view(const Body& body, double time_s);
    void reset() { *this = {}; }

  private:
    void learn_arm(const Body& body, double dt_s);

    bool started_ = false;
    double time_s_ = 0;
    double arm_m_ = 0;
    glm::dmat3 axes_{1};
};

}  // namespace kino
