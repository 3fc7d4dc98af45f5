#pragma once

#include <optional>

#include "apps/pipeline/processed_frame.h"
#include "apps/viewer/scene_place.h"
#include "viz/scene/scene.h"

namespace kino {

/// How the user wants depth drawn.
struct DrawOptions {
    DepthStyle style = DepthStyle::mesh;
    int splat_px = 3;
    /// Empty: captured where there is colour, relit where there is depth only.
    std::optional<ColorMode> color;
};

/// Keeps the scene up to date with the frames of one source.
class SceneBuilder {
  public:
    /// A new source: the first frame decides where lights hang.
    void reset() { place_.reset(); }
    /// A frame without depth empties the scene.
    void show(const ProcessedFrame& frame);
    /// The scene as wanted now.
    [[nodiscard]] const Scene& scene(const DrawOptions& options);
    /// Empty before the first frame with depth.
    [[nodiscard]] const std::optional<ScenePlace>& place() const { return place_; }
    [[nodiscard]] ColorMode color_mode(const DrawOptions& options) const;

  private:
    Scene scene_;
    std::optional<ScenePlace> place_;
    bool has_color_ = false;
};

}  // namespace kino
