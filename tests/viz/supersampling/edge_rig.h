#pragma once

#include <array>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "base/image.h"
#include "tests/reference/edge_reference.h"
#include "viz/frame/supersampled_stage.h"
#include "viz/graph/executor.h"

namespace kino::test {

/// A sample, or a pixel's centre, as the device stores it.
struct StoredSurface {
    Rgba8 albedo{0, 0, 0, 255};  ///< alpha 0: background
    float z = 2;
    std::uint32_t normal = 0;  ///< octahedral, two 16-bit snorm
    std::uint32_t object = 1u << 16 | 1;
    friend bool operator==(const StoredSurface&, const StoredSurface&) = default;
};
[[nodiscard]] std::uint32_t stored_normal(const glm::dvec3& normal);

/// A finished picture with one sample, and what four samples of every pixel show.
struct EdgeScene {
    Scene scene;  ///< exposure, colour mode and materials
    View view;
    Image<StoredSurface> centre;
    std::array<Image<StoredSurface>, 4> samples;
    Image<std::uint64_t> linear;  ///< four halves
};

struct EdgeResult {
    Image<std::uint64_t> linear;
    std::vector<std::uint32_t> listed;  ///< y << 16 | x
    std::uint32_t found = 0;            ///< edges, listed or not
    std::uint32_t cap = 0;
};

/// Runs add_edge_list() and add_edge_samples() on made pictures.
class EdgeRig {
  public:
    explicit EdgeRig(gpu::Device& device)
        : device_(device), pipelines_(device), executor_(device, pipelines_) {}
    [[nodiscard]] EdgeResult run(const EdgeScene& scene, const StageOptions& options);

  private:
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
};

/// For the double reference; the normals of samples have fewer bits.
[[nodiscard]] reference::EdgeSurface as_reference(const StoredSurface& s, const Scene& scene,
                                                  bool sample);
[[nodiscard]] reference::EdgeRules rules_of(const EdgeScene& scene, const StageOptions& options);

}  // namespace kino::test
