#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "skeleton/tracking/jointed_model.h"

namespace kino {

/// Where a bone tends to be if nothing is seen of it.
struct RestDirection {
    Segment segment;
    glm::vec3 target{0};     ///< unit, depth-camera space
    int frame_unknown = -1;  ///< first unknown of the turn that carries the target; -1: none
    float sigma = 1;
};

constexpr std::size_t kDirectionLimits = 27;

/// dot(outward, direction) <= most.
struct DirectionLimit {
    Segment segment;
    glm::vec3 outward{0};
    float most = 1;
};

/// Tendencies of the pose as it is. Limbs refer to the bone before them.
[[nodiscard]] std::array<RestDirection, kSegmentCount> rest_directions(const JointedPose& pose);

/// Limits of shoulders, elbows, hips, knees and ankles about the pose as it is: hinges bend one
/// way.
[[nodiscard]] std::array<DirectionLimit, kDirectionLimits> direction_limits(
    const JointedPose& pose);

/// The chest's or pelvis's frame carried along a limb's first bone by the shortest turn from
/// hanging down: columns left, up (against the bone), forward (where the next bone may bend to).
[[nodiscard]] glm::mat3 limb_frame(const glm::mat3& body, const glm::vec3& direction);

}  // namespace kino
