#pragma once

#include <span>
#include <vector>

#include "apps/bench/governor_script.h"
#include "apps/viewer/picture_levels.h"
#include "viz/frame/renderer.h"

namespace kino::bench {

/// Options that draw at a level.
[[nodiscard]] FrameOptions options_at(const PictureLevel& level);

/// What a level loses on the script, against full quality of the same frames.
struct LevelError {
    PictureLevel level;
    double flip = 0;        ///< mean FLIP, mean of the frames
    double worst_flip = 0;  ///< of the frame that it is highest in
    double psnr_db = 0;     ///< mean of the frames that differ at all
};

/// Draws every `every`th frame of the script in full and at all levels.
[[nodiscard]] Result<std::vector<LevelError>> measure_level_errors(
    Renderer& renderer, GovernorScript& script, std::span<const PictureLevel> levels, int every);

}  // namespace kino::bench
