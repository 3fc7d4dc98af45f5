#pragma once

#include <glm/vec3.hpp>

#include "skeleton/people/blob.h"

namespace kino {

/// Seen from above, upright axes.
[[nodiscard]] float level_distance(const glm::vec3& a, const glm::vec3& b);

/// Area within `within_m` of a place, seen from above.
[[nodiscard]] float area_around(const Blob& blob, const glm::vec3& middle, float within_m);

/// How far the box of `a` is outside that of `b`, in units of the two distances, and of 0.25 m more
/// towards the camera, where things are held; below 1 `a` may belong to `b`.
[[nodiscard]] float apart(const Blob& a, const Blob& b, float sideways_m, float upwards_m);

/// A trunk that an arm or a collar parts from its head.
[[nodiscard]] bool trunk_of(const Blob& main, const Blob& piece);

/// What was his a moment ago, and is near his trunk or moves: a desk on which he leant does not.
[[nodiscard]] bool limb_of(const Blob& main, const Blob& piece);

/// Somebody of his own, whoever may be beside him; a fist before a shoulder is not.
[[nodiscard]] bool independent(const Blob& blob);

}  // namespace kino
