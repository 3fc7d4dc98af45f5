#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "viz/graph/executor.h"
#include "viz/graph/graph.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_bounds.h"

namespace kino {

/// How depth pixels become picture pixels. All paths fill the same surface.
enum class RasterPath : std::uint8_t {
    compute,        ///< visibility buffer with 64-bit atomics
    compute_32bit,  ///< the same bits by two passes of 32-bit atomics
    hardware        ///< fixed-function points, or grid + geometry shader: the reference
};

/// The thin surface, one texture each; invalid ids are not wanted and not made. Formats are the
/// attachment formats in viz/surface/surface_out.glsl.
struct SurfaceTargets {
    graph::TextureId albedo;  ///< RGBA8 (or the final target's format); always made
    graph::TextureId view_z;  ///< R32F, metres along the view axis, 0 = nothing
    graph::TextureId normal;  ///< RG16 snorm, octahedral, view space
    graph::TextureId id;      ///< R32UI: depth pixel (cloud) or triangle (mesh), ~0 = nothing
    graph::TextureId object;  ///< R32UI: material << 16 | object id; 0: live depth or nothing
    VkRect2D live{};  ///< outside of it nothing of the live frame is; without area: not known
};
constexpr VkFormat kViewZFormat = VK_FORMAT_R32_SFLOAT;
constexpr VkFormat kNormalFormat = VK_FORMAT_R16G16_SNORM;
constexpr VkFormat kIdFormat = VK_FORMAT_R32_UINT;

struct DepthPassInputs;
/// Makes a colour (sRGB-coded RGBA8) for every depth pixel.
using Recolor = std::function<graph::BufferId(graph::FrameGraph&, const DepthPassInputs&)>;

/// Draws a live depth frame as points or as a mesh. Owns the GPU copy of the frame; memory is
/// made for the first frame and kept while the size stays.
class DepthRasterizer {
  public:
    explicit DepthRasterizer(gpu::Device& device) : device_(device) {}

    /// Copies the frame into mapped memory unless this version is there already. The GPU must
    /// not be reading it (Executor::run waits).
    [[nodiscard]] Result<void> upload(const DepthSurface& surface);

    /// Adds the passes that draw the uploaded frame into `targets` and returns their new ids.
    /// `background_*` are packed sRGB RGBA8. `recolor`, if set, makes the colours to draw with from
    /// the frame and its normals.
    [[nodiscard]] SurfaceTargets add(graph::FrameGraph& graph, const LiveDepth& live,
                                     const View& view, RasterPath path, SurfaceTargets targets,
                                     std::uint32_t background_top, std::uint32_t background_bottom,
                                     const Recolor& recolor = nullptr) const;

    [[nodiscard]] std::uint64_t bytes() const;
    /// Gives the memory back.
    void clear();

  private:
    struct Inputs;
    gpu::Device& device_;
    gpu::Buffer depth_;
    gpu::Buffer rays_;
    gpu::Buffer color_;
    mutable gpu::Buffer indices_;  ///< hardware mesh only, made when first drawn
    std::shared_ptr<const Image<RayXy>> uploaded_rays_;
    std::uint64_t version_ = 0;
    std::uint32_t width_ = 0;
    std::uint32_t height_ = 0;
    double focal_px_ = 0;
    bool has_color_ = false;
    DepthBounds bounds_;
    std::optional<glm::vec4> pinhole_;  ///< 1/fx, 1/fy, cx, cy where the rays are a plain pinhole's
};

}  // namespace kino
