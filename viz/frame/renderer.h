#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "viz/frame/stage.h"
#include "viz/gpu/device.h"
#include "viz/graph/executor.h"
#include "viz/quality/zoom/zoom_pass.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// Where a finished picture goes. `image` must be in the GENERAL layout, colour-attachment and
/// transfer-source and -destination capable, RGBA8 or BGRA8 (no sRGB view: values are sRGB-coded
/// already).
struct PictureTarget {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkExtent2D extent{};
    VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
};

/// How often virtual light is worked out.
enum class LightRate : std::uint8_t {
    depth_pixel,   ///< once a depth pixel, before drawing: fast
    picture_pixel  ///< once a picture pixel: the reference
};

struct FrameOptions {
    LightRate light_rate = LightRate::depth_pixel;
    RasterPath raster = RasterPath::compute;
    /// How lights are assigned to tiles, in scenes that have many.
    LightListOptions light_lists;
    RayShadowOptions ray_shadows;
    BounceOptions bounces;  ///< of spotlights that ask for one bounce
    /// Set: light is worked out on a coarser surface, where the scene is staged (stage.h).
    std::optional<FramebufferLodOptions> lod;
    PartRates part_rates;                     ///< resizing of parts of the light (stage.h)
    std::optional<RegionLodOptions> regions;  ///< resizing by tiles (stage.h)
    /// 4: scenes with meshes get smooth edges: shaded (multisampled_stage.h) or, with lod, whose r
    /// may be 1, from light that is there (supersampled_stage.h). 1 costs nothing.
    std::uint32_t samples = 1;
    SampleResolve resolve = SampleResolve::as_shown;
    float edge_share = 0.25f;  ///< with lod and samples: at most this share of the picture is edge
    ZoomOptions zoom;  ///< the whole picture coarser, enlarged by copying; the overlay is not
    /// Set: the finished picture is brought to the newest pose, just before the overlay.
    std::optional<DeflectOptions> deflect;
    graph::Timing timing = graph::Timing::frame;
    /// Also copies the view depth under this pixel back (FrameStats::depth_at_m).
    std::optional<glm::ivec2> probe_px;
    /// Copies the finished picture (and, if asked, the surface) back to the host.
    bool read_picture = false;
    bool read_surface = false;  ///< depth, ids and normals
    bool read_view_z = false;   ///< depth alone: draws as for the screen
    bool count_fixed = false;   ///< with lod->fix_share: FrameResult::fixed
    /// Adds passes after everything else, into the target: the user interface.
    std::function<graph::TextureId(graph::FrameGraph&, graph::TextureId target)> overlay;
};

/// The surface as the host gets it, for tests, picking and benches. Row-major; of the size it is
/// drawn at: the picture's, or that of zoomed_view() of a zoomed or deflected one.
struct SurfaceReadback {
    Image<float> view_z_m;        ///< 0: nothing
    Image<std::uint32_t> id;      ///< depth pixel (cloud) or triangle (mesh); ~0: nothing
    Image<std::uint32_t> normal;  ///< octahedral, two 16-bit snorm, view space
};

/// Pixels of a coarse picture that no coarse pixel resembled.
struct FixedPixels {
    std::uint32_t failed = 0;  ///< all of them
    std::uint32_t shaded = 0;  ///< that were shaded anew; fewer where the cap is reached
};

struct FrameResult {
    graph::FrameReport report;
    double ms = 0;  ///< device time of the whole frame, submit to fence
    Image<Rgba8> picture;
    SurfaceReadback surface;
    std::optional<float> depth_at_m;  ///< of the probed pixel; empty where nothing is there
    std::optional<FixedPixels> fixed;
};

/// Composes frames: what the scene calls for, in stage order, and nothing else.
class Renderer {
  public:
    explicit Renderer(gpu::Device& device);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Draws and waits. Fails where the device does; the scene was checked when it was loaded.
    [[nodiscard]] Result<FrameResult> render(const Scene& scene, const View& view,
                                             const PictureTarget& target,
                                             const FrameOptions& options);

    /// Draws into a picture of its own and hands it back.
    [[nodiscard]] Result<FrameResult> render_to_image(const Scene& scene, const View& view,
                                                      const FrameOptions& options);

    /// The picture cuts: histories are void.
    void cut();

    [[nodiscard]] gpu::Device& device() { return device_; }
    [[nodiscard]] gpu::Pipelines& pipelines() { return pipelines_; }
    [[nodiscard]] const std::vector<graph::GroupTime>& group_times() const {
        return executor_.group_times();
    }
    /// Bytes of the live depth copy on the device.
    [[nodiscard]] std::uint64_t live_depth_bytes() const { return rasterizer_.bytes(); }
    /// Bytes of the meshes that the last scene showed.
    [[nodiscard]] std::uint64_t mesh_bytes() const { return meshes_.bytes(); }
    /// What became of the last frame's picture on its way to full size.
    [[nodiscard]] const ZoomReport& zoom_report() const { return zoom_.report(); }
    /// Bytes of mapped memory that zooming takes.
    [[nodiscard]] std::uint64_t zoom_bytes() const { return zoom_.bytes(); }
    /// Bytes of the tree that rays are cast through.
    [[nodiscard]] std::uint64_t bvh_bytes() const { return bvh_.bytes(); }
    /// The last frame's graph, for documentation and debugging.
    [[nodiscard]] const std::string& graphviz() const { return graphviz_; }
    void keep_graphviz(bool keep) { keep_graphviz_ = keep; }
    /// For tests (graph::Executor::set_poison).
    void poison_memory(bool poisons) { executor_.set_poison(poisons); }

  private:
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    DepthRasterizer rasterizer_;
    MeshDrawer meshes_;
    SceneBvh bvh_;
    ZoomPass zoom_;
    gpu::Texture own_target_;
    gpu::Buffer picture_readback_;
    gpu::Buffer view_z_readback_;
    gpu::Buffer id_readback_;
    gpu::Buffer normal_readback_;
    gpu::Buffer probe_readback_;
    gpu::Buffer fixed_readback_;
    bool keep_graphviz_ = false;
    std::string graphviz_;
};

}  // namespace kino
