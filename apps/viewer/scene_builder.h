#pragma once

#include <memory>
#include <optional>

#include "apps/pipeline/processed_frame.h"
#include "apps/stage/director.h"
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
    /// A stage around what is shown; null: none.
    void put_on_stage(std::unique_ptr<Director> director) { director_ = std::move(director); }
    [[nodiscard]] const Director* director() const { return director_.get(); }
    /// A new source: the first frame decides where lights hang and the stage stands.
    void reset();
    /// A frame without depth empties the scene.
    void show(const ProcessedFrame& frame);
    /// The stage's time goes on; without a stage nothing happens. True if the stage stands
    /// elsewhere now, and cameras should go with it.
    bool advance(double dt_s);
    /// The scene as wanted now.
    [[nodiscard]] const Scene& scene(const DrawOptions& options);
    /// Empty before the first frame with depth; with a stage, where its view begins.
    [[nodiscard]] const std::optional<ScenePlace>& place() const { return place_; }
    [[nodiscard]] const Scene& last_scene() const { return scene_; }
    [[nodiscard]] ColorMode color_mode(const DrawOptions& options) const;

  private:
    void show_cut_out(const ProcessedFrame& frame);

    Scene scene_;
    std::unique_ptr<Director> director_;
    std::shared_ptr<const BodyFrame> bodies_;
    Pose world_from_depth_;
    glm::dvec3 middle_m_{0};
    std::optional<ScenePlace> place_;
    bool has_color_ = false;
};

}  // namespace kino
