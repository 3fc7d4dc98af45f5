#pragma once

#include "apps/demo/demo_play.h"
#include "apps/demo_show/ui_canvas.h"
#include "viz/scene/view.h"

namespace kino {

/// Height of the words of guidance, as a part of the picture's: 42 px of 720, which is read from
/// three metres away on a common screen.
constexpr float kGuidanceWords = 0.058f;

/// Draws what a person is told beside the joint that it is about, or at the lower edge where there
/// is none: the outline of the gesture, how far they got, a few words; and a flash for the gesture
/// that was just recognised. `color`: of the lines, sRGB.
void draw_guidance(const UiCanvas& canvas, const View& view, const DemoGuidance& guidance,
                   glm::vec3 color);

/// Whether there is anything of it to draw.
[[nodiscard]] bool says_anything(const DemoGuidance& guidance);

}  // namespace kino
