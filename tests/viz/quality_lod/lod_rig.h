#pragma once

#include <functional>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "tests/reference/lod_reference.h"
#include "viz/graph/executor.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/guided_depth.h"
#include "viz/quality/lod_fix_shared.h"
#include "viz/scene/scene.h"

namespace kino::test {

/// A fine surface as the host holds it; `object` may be empty.
struct LodScene {
    View view;
    Image<Rgba8> albedo;  ///< sRGB, alpha 0: nothing there
    Image<float> z;
    Image<std::uint32_t> normal;  ///< octahedral, two 16-bit snorm
    Image<std::uint32_t> object;
};

/// A scene of one colour at 2 m that faces the viewer.
[[nodiscard]] LodScene plain_scene(int width, int height);
[[nodiscard]] std::uint32_t packed_normal(const glm::dvec3& normal);
[[nodiscard]] glm::dvec3 unpacked_normal(std::uint32_t bits);
[[nodiscard]] double from_srgb(double c);

/// What one run of both passes makes.
struct LodResult {
    View coarse_view;
    Image<Rgba8> albedo;  ///< of the coarse surface
    Image<float> z;
    Image<std::uint32_t> normal;
    Image<std::uint32_t> object;
    Image<std::uint32_t> guide;  ///< empty where there is none
    Image<glm::vec4> coarse;     ///< the linear picture that was resized
    Image<glm::vec4> picture;
    std::vector<std::string> passes;
    bool direct = false;               ///< no pass was added
    std::vector<std::uint32_t> fixed;  ///< pixels to be shaded anew, y << 16 | x
    shared::LodFixState fix{};         ///< all 0 without a list
};

/// Linear colour of coarse pixel (x, y) for a coarse albedo.
using LodShading = std::function<glm::vec4(int x, int y, const glm::vec3& linear_albedo)>;

/// Picks, shades on the host, reconstructs and reads everything back.
class LodRig {
  public:
    explicit LodRig(gpu::Device& device)
        : device_(device), pipelines_(device), executor_(device, pipelines_) {}
    [[nodiscard]] LodResult run(const LodScene& scene, const FramebufferLodOptions& options,
                                const LodShading& shading);
    /// The picture finished by the last pass, and finished on the way.
    struct Finished {
        Image<Rgba8> apart;
        Image<Rgba8> on_the_way;
    };
    [[nodiscard]] Finished finish(const LodScene& scene, const FramebufferLodOptions& options,
                                  const LodShading& shading, const Scene& rules);
    /// add_guided_depth() of these pictures; R32F bits.
    [[nodiscard]] Image<float> guided_depth(const Image<float>& depth, const Image<Rgba8>& color,
                                            const GuidedDepthOptions& options);
    [[nodiscard]] const gpu::Pipelines& pipelines() const { return pipelines_; }
    void set_poison(bool poisons) { executor_.set_poison(poisons); }

  private:
    struct Frame;
    static SurfaceTargets fine_surface(Frame& frame, const LodScene& scene);
    /// The coarse picture as the host shades it.
    static Image<std::uint64_t> shade(const LodScene& scene, const View& coarse,
                                      const FramebufferLodOptions& options,
                                      const LodShading& shading);
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
};

/// The double reference on the same inputs. Packed: guides and light as their words hold them.
/// `doubt_bits` becomes -log2 of every pixel's confidence.
[[nodiscard]] Image<glm::dvec3> lod_reference_picture(const LodScene& scene,
                                                      const LodResult& result,
                                                      const FramebufferLodOptions& options,
                                                      Image<double>* doubt_bits = nullptr);
/// The coarse picture as the reference reads it.
[[nodiscard]] Image<reference::LodSample> lod_samples(const LodResult& result,
                                                      const FramebufferLodOptions& options);

}  // namespace kino::test
