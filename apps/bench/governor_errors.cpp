#include "apps/bench/governor_errors.h"

#include <algorithm>
#include <cmath>

#include "apps/bench/bench.h"
#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"

namespace kino::bench {

FrameOptions options_at(const PictureLevel& level) {
    FrameOptions options;
    options.zoom.z = level.zoom;
    if (!(level.lod > 1)) return options;
    options.lod = FramebufferLodOptions{.r = level.lod, .reconstruction = level.reconstruction};
    options.lod->fine_grained = level.reconstruction != Reconstruction::bilinear;
    return options;
}

Result<std::vector<LevelError>> measure_level_errors(Renderer& renderer, GovernorScript& script,
                                                     std::span<const PictureLevel> levels,
                                                     int every) {
    std::vector<LevelError> errors;
    for (const PictureLevel& level : levels) errors.push_back({.level = level});
    std::vector<int> unequal(levels.size(), 0);
    int frames = 0;
    script.restart();
    renderer.cut();
    for (int i = 0; i < script.frames(); ++i) {
        const auto moment = script.next();
        if (i % every != every / 2) continue;
        ++frames;
        KINO_ASSIGN(const FrameResult full,
                    renderer.render_to_image(moment.scene, moment.view, {}));
        for (std::size_t k = 0; k < levels.size(); ++k) {
            KINO_ASSIGN(const FrameResult drawn,
                        renderer.render_to_image(moment.scene, moment.view, options_at(levels[k])));
            KINO_ASSIGN(const FlipResult flip, flip_error(drawn.picture, full.picture));
            KINO_ASSIGN(const ImageDifference difference,
                        compare_images(drawn.picture, full.picture));
            errors[k].flip += flip.mean;
            errors[k].worst_flip = std::max<double>(errors[k].worst_flip, flip.mean);
            if (!std::isfinite(difference.psnr_db)) continue;
            errors[k].psnr_db += difference.psnr_db;
            ++unequal[k];
        }
    }
    for (std::size_t k = 0; k < levels.size(); ++k) {
        errors[k].flip /= std::max(1, frames);
        errors[k].psnr_db = unequal[k] > 0 ? errors[k].psnr_db / unequal[k] : kNotMeasured;
    }
    return errors;
}

}  // namespace kino::bench
