#pragma once

#include <array>
#include <functional>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/image.h"
#include "tests/reference/light_reference.h"
#include "viz/graph/executor.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_shared.h"

namespace kino::test {

/// Runs the light passes on a surface made by the host, without anything drawn.
class LightRig {
  public:
    explicit LightRig(gpu::Device& device);
    ~LightRig();

    /// Gives the device its copy; normals are stored as the surface contract says.
    [[nodiscard]] Result<void> set_surface(const reference::LitSurface& surface);

    struct Options {
        LightListOptions lists;
        bool brute_force = false;  ///< lists are made, and every pixel walks all lights anyway
        bool shade = true;
        bool statistics = true;
        bool read = true;
        graph::Timing timing = graph::Timing::frame;
        /// Four words a pixel, if any light casts shadows.
        std::vector<std::uint32_t> shadow_masks{};
        /// In place of shading: what to draw from the lists.
        std::function<graph::TextureId(graph::FrameGraph&, const LightLists&,
                                       const SurfaceTargets&)>
            instead{};
        bool own_lists = false;  ///< `instead` makes lists of its own: none are made before it
        /// A coarser picture of the same view, which the surface is of; the lists are then made of
        /// `lists_z`.
        std::optional<View> shading_view{};
        const Image<float>* lists_z = nullptr;
    };
    struct Drawn {
        LightLists lists;
        Image<glm::vec4> linear;
        Image<std::uint64_t> bits;  ///< the same, as it lies in memory
        std::vector<std::uint32_t> headers, indices;
        std::vector<shared::LightRecord> records;
        shared::LightListCounters counters{};
        graph::FrameReport report;
        std::vector<graph::GroupTime> times;

        /// Indices into Scene::lights of a tile's list, in the list's order.
        [[nodiscard]] std::vector<std::uint32_t> list(std::size_t tile) const;
        [[nodiscard]] double ms(const std::string& group) const;
    };
    [[nodiscard]] Result<Drawn> draw(const Scene& scene, const View& view, const Options& options);

    [[nodiscard]] gpu::Pipelines& pipelines() { return pipelines_; }

  private:
    Result<void> upload(gpu::Texture& texture, const char* name, VkFormat format, int width,
                        int height, const void* bytes, std::size_t count);
    Result<const gpu::Buffer*> host_buffer(std::size_t slot, std::uint64_t bytes);

    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    gpu::Texture albedo_, view_z_, normal_, object_, lists_z_;
    std::array<gpu::Buffer, 5> readback_;
    gpu::Buffer masks_;
};

}  // namespace kino::test
