#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "viz/scene/scene_file.h"

namespace kino {

/// Where one light of a swarm is at one moment.
struct SwarmMoment {
    glm::dvec3 stage_m{0};
    double weight = 1;  ///< of its intensity
};

/// Many lights by chance: everything about one follows from the seed, its number and the time.
class Swarm {
  public:
    struct One {
        glm::dvec3 seat{0};   ///< -1..1 along each axis of the box
        glm::dvec3 phase{0};  ///< rad
        glm::dvec3 pace{1};   ///< about 1
        std::size_t color = 0;
        double intensity = 0;
        double radius_m = 0;
    };

    explicit Swarm(const SceneSwarm& file);

    [[nodiscard]] const SceneSwarm& file() const { return file_; }
    [[nodiscard]] const std::vector<One>& all() const { return all_; }
    /// Within the box at any time.
    [[nodiscard]] SwarmMoment at(std::size_t i, double time_s) const;

  private:
    SceneSwarm file_;
    std::vector<One> all_;
};

}  // namespace kino
