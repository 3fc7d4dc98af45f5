#pragma once

#include <vector>

#include "apps/calibrate/guided_capture.h"
#include "viz/output/ui/ui_renderer.h"

namespace kino {

/// Everything that the window shows of one frame, as Dear ImGui's lists; between begin and end of
/// an ImGui frame. `pictures`: one a camera, null where there is none yet.
void draw_guide(const GuidedFrame& frame, const Board& board,
                const std::vector<UiPicture*>& pictures);

/// While nothing comes from the device.
void draw_waiting(const char* words);

}  // namespace kino
