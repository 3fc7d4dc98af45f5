#pragma once

#include <glm/vec4.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/image.h"
#include "viz/graph/executor.h"
#include "viz/quality/framebuffer_lod.h"

namespace kino::bench {

/// What a scene's costly term is: 0 soft shadow of n x n taps, 1 procedural noise and Phong,
/// 2 ambient occlusion by rays, 3 point lights.
enum class LodKind : std::uint32_t { car, dragon, chess, room };

/// A surface on the host with what shades it.
struct LodStage {
    std::string name;
    LodKind kind = LodKind::car;
    View view;
    Image<Rgba8> albedo;
    Image<float> z;
    Image<std::uint32_t> normal;
    std::vector<glm::vec4> things;  ///< eight balls, or two words a light
    std::uint32_t trips = 9;
};

/// Balls on a ground, made by rays; car, dragon and chess differ in shapes, textures and terms.
[[nodiscard]] LodStage made_stage(LodKind kind, int width, int height);
/// A recorded room as a mesh, orbited, with 16 lights.
[[nodiscard]] Result<LodStage> room_stage(gpu::Device& device, int width, int height);

/// Draws a stage on a device, directly or at a coarse size.
class LodPlayer {
  public:
    [[nodiscard]] static Result<std::unique_ptr<LodPlayer>> create(gpu::Device& device,
                                                                   const LodStage& stage);

    /// Shades every pixel.
    [[nodiscard]] Result<void> direct();
    /// Picks, shades the coarse picture, reconstructs.
    [[nodiscard]] Result<void> resized(const FramebufferLodOptions& options);
    /// The same without shading: the coarse picture is what was shaded last at this size.
    [[nodiscard]] Result<void> reconstruction(const FramebufferLodOptions& options);
    /// And the picture finished on the way: exposure, tone map, sRGB, dither.
    [[nodiscard]] Result<void> finished(const FramebufferLodOptions& options);
    /// The last pass alone, as every picture that is not finished on the way needs it.
    [[nodiscard]] Result<void> last_pass();
    /// Milliseconds of each pass of the last resized() drawn once more, pass by pass.
    [[nodiscard]] Result<std::vector<graph::GroupTime>> pass_times(
        const FramebufferLodOptions& options);

    /// The picture, sRGB-coded; shaded at every pixel where there are no options.
    [[nodiscard]] Result<Image<Rgba8>> picture(const FramebufferLodOptions* options = nullptr);
    void set_trips(std::uint32_t trips) { stage_.trips = trips; }
    [[nodiscard]] const LodStage& stage() const { return stage_; }

  private:
    enum class What : std::uint8_t { direct, resized, reconstruction, finished };
    LodPlayer(gpu::Device& device, LodStage stage)
        : device_(device),
          stage_(std::move(stage)),
          pipelines_(device),
          executor_(device, pipelines_) {}
    Result<void> draw(What what, const FramebufferLodOptions& options, graph::Timing timing);
    /// A grey picture of a size, made once.
    Result<void> fill_grey(gpu::Texture& texture, int width, int height);
    /// Where finished pictures go.
    graph::TextureId target(graph::FrameGraph& graph) const;
    graph::TextureId shade(graph::FrameGraph& graph, const SurfaceTargets& surface,
                           const View& view);

    gpu::Device& device_;
    LodStage stage_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    gpu::Texture albedo_, z_, normal_;
    gpu::Texture coarse_;  ///< shaded last, for reconstruction()
    gpu::Texture whole_;   ///< for last_pass()
    gpu::Buffer readback_;
    bool reading_ = false;
};

}  // namespace kino::bench
