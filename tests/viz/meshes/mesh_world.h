#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tests/viz/viz_fixture.h"
#include "viz/graph/executor.h"
#include "viz/surface/mesh_drawer.h"

namespace kino::test {

/// What a picture of meshes alone consists of, back on the host.
struct MeshPicture {
    Image<Rgba8> albedo;
    Image<float> view_z_m;
    Image<std::uint32_t> normal;  ///< octahedral, two snorm16
    Image<std::uint32_t> id;
    Image<std::uint32_t> object;
    Image<float> depth;  ///< reversed, of the depth target
    graph::FrameReport report;
    shared::MeshCounters counters{};
    /// What the device was told to draw, where it culled.
    std::vector<VkDrawIndexedIndirectCommand> commands;
};

/// Bytes of every target but the depth.
[[nodiscard]] bool same(const MeshPicture& a, const MeshPicture& b);

/// Unit normal in view space of a packed one.
[[nodiscard]] glm::dvec3 unpack_normal(std::uint32_t bits);

/// Draws meshes over an empty surface, or over one with `behind_m` everywhere.
class MeshWorld {
  public:
    explicit MeshWorld(gpu::Device& device);

    [[nodiscard]] MeshPicture draw(const Scene& scene, const View& view,
                                   const MeshListOptions& options = {}, float behind_m = 0);

    /// The same for a list made by `make` in the frame's graph.
    [[nodiscard]] MeshPicture draw_list(const View& view,
                                        const std::function<MeshList(graph::FrameGraph&)>& make,
                                        float behind_m = 0);

    MeshDrawer drawer;
    gpu::Pipelines pipelines;
    graph::Executor executor;

  private:
    gpu::Device& device_;
};

/// A camera that looks from `eye` at `target`.
[[nodiscard]] View view_from(const glm::dvec3& eye, const glm::dvec3& target, int width = 96,
                             int height = 72);

/// A node of `mesh`; the material is an index into Scene::materials plus one.
[[nodiscard]] MeshNode node_of(std::shared_ptr<const MeshAsset> mesh, std::uint32_t id,
                               const glm::dmat4& world_from_object = glm::dmat4(1.0),
                               std::uint32_t material = 0);

/// Boxes, spheres, cones and tori of many poses, stretched and mirrored, before and beside a
/// camera at the origin that looks along -z.
[[nodiscard]] Scene mixed_scene(int nodes, unsigned seed);

}  // namespace kino::test
