#include "viz/quality/zoom/zoom_view.h"

#include <algorithm>

#include "base/check.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {

int usable_zoom(int wanted, int width, int height) {
    return std::max(1, std::min({wanted, kMaxZoom, width, height}));
}

View zoomed_view(const View& view, int z, int guard_px) {
    KINO_CHECK(z >= 1 && guard_px >= 0);
    if (z == 1 && guard_px == 0) return view;  // to the bit
    View small = view;
    small.width = (view.width + z - 1) / z + 2 * guard_px;
    small.height = (view.height + z - 1) / z + 2 * guard_px;
    small.projection.fx = view.projection.fx / z;
    small.projection.fy = view.projection.fy / z;
    // Scaling acts on pixel corners, centres sit half a pixel inside.
    small.projection.cx = (view.projection.cx + 0.5) / z - 0.5 + guard_px;
    small.projection.cy = (view.projection.cy + 0.5) / z - 0.5 + guard_px;
    return small;
}

}  // namespace kino
