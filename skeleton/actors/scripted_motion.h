#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "skeleton/actors/actor_motion.h"

namespace kino {

/// Ten seconds each, made for hard cases:
/// "back", "sideways": arms, turned away or to a side; "lie": on the back, an arm goes up;
/// "cross": to and fro across the view, a second actor the other way; "enter": from beyond the
/// border to the middle, a wave, and out; "hug": with a second actor; "hold": a large box in both
/// hands; "wall": a hand on the wall.
[[nodiscard]] const std::vector<std::string>& scripted_motions();
/// Null for other names.
[[nodiscard]] std::shared_ptr<const ActorMotion> scripted_motion(const std::string& name,
                                                                 std::uint64_t seed);

}  // namespace kino
