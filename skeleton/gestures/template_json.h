#pragma once

#include "sensor/json_cursor.h"
#include "skeleton/gestures/gesture_template.h"

namespace kino {

/// {"name", "hand": "left"|"right"|"both", "least_s", "most_s", "threshold", "examples": [[[lx, ly,
/// lz, rx, ry, rz], ... 32 of them], ...]}; unknown keys are errors.
[[nodiscard]] Result<GestureTemplate> template_from_json(const JsonCursor& object);
[[nodiscard]] nlohmann::ordered_json template_to_json(const GestureTemplate& gesture);

}  // namespace kino
