#pragma once

#include <string>
#include <vector>

#include "tests/reference/raster_reference.h"
#include "viz/frame/renderer.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::test {

/// A view of a depth scene that a path must get right.
struct NamedView {
    std::string name;
    View view;
};

/// Sensor, orbit, close-up and camera inside the cloud, `width` x `height`.
[[nodiscard]] std::vector<NamedView> standard_views(const LiveDepth& live,
                                                    const CameraModel& camera, int width,
                                                    int height);

/// The double-precision picture of the same points (1 px each) or triangles. Triangle ids count
/// all of the grid, torn ones too, as the renderer's do.
[[nodiscard]] Image<reference::RasterSample> reference_picture(const LiveDepth& live,
                                                               const View& view);

struct Agreement {
    std::int64_t union_px = 0;      ///< covered in either
    std::int64_t agreeing_px = 0;   ///< same id, or depth within 1 mm and colour within 2/255
    std::int64_t reference_px = 0;  ///< covered in the reference
    std::int64_t covered_px = 0;    ///< covered in the picture
    [[nodiscard]] double share() const {
        return union_px == 0 ? 1.0
                             : static_cast<double>(agreeing_px) / static_cast<double>(union_px);
    }
    [[nodiscard]] double coverage() const {
        return reference_px == 0
                   ? 1.0
                   : static_cast<double>(covered_px) / static_cast<double>(reference_px);
    }
};
[[nodiscard]] Agreement compare_with_reference(const FrameResult& frame,
                                               const Image<reference::RasterSample>& reference);

/// Wall, floor, a sphere before them and a step, with holes and noise of a kind: metres.
[[nodiscard]] double test_depth(const CameraModel& camera, int x, int y);
[[nodiscard]] Rgba8 test_color(int x, int y);

}  // namespace kino::test
