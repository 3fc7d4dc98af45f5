#pragma once

#include <cstdint>
#include <memory>

#include "base/error.h"
#include "viz/graph/graph.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

constexpr VkFormat kObjectFormat = VK_FORMAT_R32_UINT;  ///< material << 16 | object id; 0: live
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

/// How draws are submitted; every way makes the same picture.
enum class MeshSubmit : std::uint8_t {
    multi_draw,     ///< culled on the device, one indirect call
    one_call_each,  ///< the rival
    fixed_function  ///< vertex buffers and attributes, one call each: the reference
};

/// Draws the scene's meshes into the thin surface by programmable vertex pulling (GPU Pro 4,
/// Riccio and Lilley). Keeps the meshes' device memory while scenes show them.
class MeshDrawer {
  public:
    explicit MeshDrawer(gpu::Device& device);
    ~MeshDrawer();

    /// Brings the device's copies up to date: new meshes in, those that no node shows out. No
    /// device work for a scene without meshes, and bytes() is 0 after it. The GPU must not be
    /// reading (Executor::run waits).
    [[nodiscard]] Result<void> upload(const Scene& scene);

    /// Adds the passes that draw the opaque meshes over what `targets` hold, nearer wins: all
    /// targets must have been written already. `depth` (kDepthFormat, reversed) must hold the
    /// depths of what is there. targets.albedo gets the base colour as sRGB, alpha 1.
    struct Drawn {
        SurfaceTargets targets;
        graph::TextureId depth;
    };
    [[nodiscard]] Drawn add(graph::FrameGraph& graph, const Scene& scene, const View& view,
                            SurfaceTargets targets, graph::TextureId depth,
                            MeshSubmit submit = MeshSubmit::multi_draw) const;

    [[nodiscard]] std::uint64_t bytes() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace kino
