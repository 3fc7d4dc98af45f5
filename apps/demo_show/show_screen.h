#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/demo/demo_play.h"
#include "apps/demo_show/guidance_overlay.h"
#include "viz/output/ui/ui_context.h"
#include "viz/output/ui/ui_renderer.h"
#include "viz/scene/view.h"

namespace kino {

/// What is written over the picture.
struct ShowScreen {
    /// A strip at the upper edge; empty: none.
    std::string banner;
    /// In place of guidance: what happened, in large letters, and what to do about it.
    struct Trouble {
        std::string what, remedy;
    };
    std::optional<Trouble> trouble;
    std::array<const DemoGuidance*, 2> guidance{};  ///< of one person each; null: none
    /// World, where they made the gesture that is praised; empty: at the joint that guidance is at.
    std::array<std::optional<glm::dvec3>, 2> praised_m{};
    std::string scene_name;  ///< shown for a moment after a change
    double scene_name_shown_s = 1e9;
    bool keys = false;
    std::string note;                ///< at the lower left
    bool records = false;            ///< a session is being written
    std::vector<std::string> stats;  ///< small, at the upper left

    [[nodiscard]] bool empty() const;
};

/// Draws the screen within a frame of the UiContext, `dt_s` after the last. `spots`: of the two
/// people's guidance, kept from picture to picture.
void draw_screen(const UiCanvas& canvas, const View& view, const ShowScreen& screen, double dt_s,
                 std::array<GuidanceSpot, 2>& spots);

}  // namespace kino
