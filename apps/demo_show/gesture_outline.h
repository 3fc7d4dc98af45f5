#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "apps/demo/demo_play.h"

namespace kino {

/// A line of an outline, in a square from -1 to 1: x to the right, y down.
struct OutlineLine {
    std::vector<glm::vec2> points;  ///< two at least
    float strength = 1;             ///< 0 to 1
    bool filled = false;            ///< the (convex) shape that the line goes round
};

/// How the gesture of a hint is made, at a moment of its endless repetition: few lines, so that it
/// is understood from afar. `hand`: with which. Empty for DemoHint::none.
[[nodiscard]] std::vector<OutlineLine> gesture_outline(DemoHint hint, Hand hand, double time_s);

/// At most four short words; empty for DemoHint::none.
[[nodiscard]] const char* hint_words(DemoHint hint);
/// What was recognised, in a word.
[[nodiscard]] const char* praise_words(GestureKind kind);

}  // namespace kino
