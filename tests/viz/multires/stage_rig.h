#pragma once

#include <functional>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "viz/frame/stage.h"
#include "viz/graph/executor.h"

namespace kino::test {

/// A room with a box, a post before the wall, a torch whose light bounces, lamps with ray-cast
/// shadows and small ones without, far enough from each other's kind to be told apart.
[[nodiscard]] Scene parts_scene();
[[nodiscard]] View parts_view(int width = 160, int height = 120);

struct RigDrawn {
    Image<glm::vec4> linear;
    std::vector<std::string> passes;
    std::uint64_t transient_bytes = 0;
    double ms = 0;
};

/// Draws stages and reads their light back before the tone curve.
class StageRig {
  public:
    explicit StageRig(gpu::Device& device);
    ~StageRig();
    [[nodiscard]] RigDrawn draw(const Scene& scene, const View& view, const StageOptions& options);
    /// Any texture of the view's size, RGBA16F, made from the surface and what lies in the stage.
    using Make = std::function<graph::TextureId(graph::FrameGraph&, const StageParts&)>;
    [[nodiscard]] RigDrawn draw(const Scene& scene, const View& view, const Make& make);
    [[nodiscard]] const gpu::Pipelines& pipelines() const { return pipelines_; }

  private:
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    DepthRasterizer live_;
    MeshDrawer meshes_;
    SceneBvh bvh_;
    gpu::Buffer readback_;
};

/// One for the whole program: making pipelines takes longer than most tests.
[[nodiscard]] StageRig& shared_rig(gpu::Device& device);

/// Mean of squared differences and the largest one, over red, green and blue of display light
/// (clamped to [0, 1], square root), where `truth` shows something.
struct LightError {
    double mse = 0, most = 0;
};
[[nodiscard]] LightError light_error(const Image<glm::vec4>& light, const Image<glm::vec4>& truth);

}  // namespace kino::test
