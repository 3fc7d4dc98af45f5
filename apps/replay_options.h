#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/body_stage.h"
#include "apps/viewer/camera_control.h"
#include "apps/viewer/frame_budget.h"
#include "apps/viewer/zoom_chooser.h"
#include "sensor/playback.h"
#include "sensor/session/recorder.h"
#include "viz/light/light_parts.h"
#include "viz/output/swapchain.h"
#include "viz/quality/lod_regions.h"
#include "viz/scene/scene.h"
#include "viz/scene/scene_file.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// How accurately pictures are drawn, and who chooses: at most one of the two, so that a frame's
/// time has one owner.
struct PictureQuality {
    FrameBudgetOptions budget;
    ZoomChooserOptions zoom;
    int samples = 1;
};

/// What `kinoscope replay` was asked for. Empty options: remembered or natural ones.
struct ReplayOptions {
    std::vector<std::string> uris;
    RasterPath raster = RasterPath::compute;
    double speed = 1;
    bool stepped = false;
    std::optional<DepthStyle> style;
    std::optional<int> splat_px;
    std::optional<ViewKind> view;
    std::optional<ColorMode> color;
    std::optional<LoopMode> loop;
    std::string filters;      ///< of depth, as DepthFilterChain::parse() reads them
    std::string calibration;  ///< as find_calibration() reads it
    BodyOptions bodies;
    bool bodies_asked = false;  ///< --bodies was given
    std::string scene;          ///< a bundled scene's name or a scene file; empty: none
    /// A scene's roles follow joints, so people are looked for unless --bodies said otherwise.
    [[nodiscard]] bool wants_people() const { return !scene.empty() && !bodies_asked; }
    std::optional<double> lod;      ///< framebuffer LOD of scenes: resizing factor; 1: off
    bool lod_auto = false;          ///< or as the frame time asks for
    std::filesystem::path lod_log;  ///< or as in the run that this file tells of; empty: not
    PartRates part_rates;           ///< of parts of a scene's light
    std::optional<RegionLodOptions> regions;  ///< of its light by tiles
    std::filesystem::path learn;              ///< headless: what its light costs; empty: not
    std::optional<int> zoom;                  ///< whole pictures so much coarser; lod_auto: at most
    SceneZoomBy zoom_by = SceneZoomBy::fixed;  ///< or who chooses that
    std::optional<int> most_zoom;              ///< of who chooses
    std::optional<double> fix_share;           ///< of the pixels, shaded anew where light is coarse
    std::optional<int> samples;                ///< a pixel, of scenes with meshes; 1 or 4
    std::optional<double> target_ms;
    PresentMode sync = PresentMode::fifo;  ///< of a window
    bool true_error = false;               ///< compare some pictures with the same ones in full
    /// What was asked for; else what the scene asks for, if there is one; else in full. Whoever was
    /// asked for here to choose does, and then nobody of the scene's.
    [[nodiscard]] PictureQuality quality(const SceneFile* stage) const;
    /// Empty, or what cannot be had together.
    [[nodiscard]] std::string contradiction() const;
    std::filesystem::path record;  ///< live: a session that is written from the start
    SessionCodec codec = SessionCodec::ffv1;
    std::filesystem::path headless;  ///< empty: a window
    std::optional<std::int64_t> frames;
    std::optional<int> width, height;
    int pictures = 12;  ///< most PNGs a source; 0: none, -1: every frame
    std::string device;
    bool json = false;
    bool verbose = false;
};

[[nodiscard]] const char* raster_name(RasterPath path);
[[nodiscard]] const char* style_name(DepthStyle style);
[[nodiscard]] const char* color_name(ColorMode mode);
[[nodiscard]] const char* loop_name(LoopMode mode);
[[nodiscard]] const char* sync_name(PresentMode mode);

/// Whether this build checks its Vulkan calls: debug builds, and where KINO_VALIDATION=1 is set.
[[nodiscard]] bool wants_validation();

}  // namespace kino
