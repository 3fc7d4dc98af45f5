#include "apps/viewer/true_error.h"

#include <algorithm>

#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"

namespace kino {

Result<TrueError> measure_true_error(Renderer& renderer, const Scene& scene, const View& view,
                                     const FrameOptions& drawn) {
    FrameOptions options = drawn;
    options.overlay = {};
    options.probe_px.reset();
    options.read_surface = options.read_view_z = false;
    KINO_ASSIGN(const FrameResult shown, renderer.render_to_image(scene, view, options));
    options.lod.reset();
    options.zoom = {};
    KINO_ASSIGN(const FrameResult full, renderer.render_to_image(scene, view, options));
    KINO_ASSIGN(const ImageDifference difference, compare_images(shown.picture, full.picture));
    KINO_ASSIGN(const FlipResult flip, flip_error(shown.picture, full.picture));
    const auto pixels = flip.map.pixels();
    const auto failed = std::count_if(pixels.begin(), pixels.end(),
                                      [](float error) { return error > kFailedFlip; });
    return TrueError{.psnr_db = difference.psnr_db,
                     .flip = flip.mean,
                     .failed_pixels = static_cast<double>(failed) /
                                      static_cast<double>(std::max<std::size_t>(1, pixels.size()))};
}

}  // namespace kino
