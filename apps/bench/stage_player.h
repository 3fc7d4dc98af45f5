#pragma once

#include <glm/vec4.hpp>

#include "base/image.h"
#include "viz/accel/scene_bvh.h"
#include "viz/frame/stage.h"
#include "viz/graph/executor.h"
#include "viz/surface/depth_rasterizer.h"
#include "viz/surface/mesh_drawer.h"

namespace kino::bench {

/// Draws stages as the renderer does, and hands their light back as it is, before the tone curve.
class StagePlayer {
  public:
    explicit StagePlayer(gpu::Device& device);
    ~StagePlayer();

    struct Drawn {
        Image<glm::vec4> linear;  ///< empty unless read
        double ms = 0;            ///< of the stage's passes, submit to fence
        std::uint64_t transient_bytes = 0;
        std::vector<graph::GroupTime> groups;  ///< with Timing::every_group
    };
    [[nodiscard]] Result<Drawn> draw(const Scene& scene, const View& view,
                                     const StageOptions& options, bool read,
                                     graph::Timing timing = graph::Timing::frame);

    /// As the last pass shows it, without rounding and dither: display light, 0 .. 1.
    [[nodiscard]] static Image<glm::dvec3> shown(const Scene& scene,
                                                 const Image<glm::vec4>& linear);

  private:
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    DepthRasterizer live_;
    MeshDrawer meshes_;
    SceneBvh bvh_;
    gpu::Buffer readback_;
};

}  // namespace kino::bench
