#pragma once

#include <optional>

#include "apps/demo/demo_play.h"
#include "apps/demo_show/ui_canvas.h"
#include "viz/scene/view.h"

namespace kino {

/// Height of the words of guidance, as a part of the picture's: 42 px of 720, which is read from
/// three metres away on a common screen.
constexpr float kGuidanceWords = 0.058f;

/// Where somebody's guidance is, so that it comes after them calmly while they move their hands. To
/// the other hand it does not go across the person, but fades in there.
struct GuidanceSpot {
    std::optional<glm::vec2> at;  ///< px; empty: nothing is shown
    DemoHint hint = DemoHint::none;
    double shown_s = 0;  ///< in this place, or on the way from it
};

/// Draws what a person is told beside the joint that it is about, or at the lower edge where there
/// is none: the outline of the gesture, how far they got, a few words; and a flash for the gesture
/// that was just recognised. `praised_m`: world, of the hand that
/// made it; empty: at the joint. `color`: of the lines, sRGB. `spot`: kept from picture to picture,
/// which are `dt_s` apart.
void draw_guidance(const UiCanvas& canvas, const View& view, const DemoGuidance& guidance,
                   const std::optional<glm::dvec3>& praised_m, glm::vec3 color, double dt_s,
                   GuidanceSpot& spot);

/// Whether there is anything of it to draw.
[[nodiscard]] bool says_anything(const DemoGuidance& guidance);

}  // namespace kino
