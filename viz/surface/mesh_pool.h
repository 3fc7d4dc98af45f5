#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "base/error.h"
#include "viz/gpu/resource.h"
#include "viz/scene/material.h"
#include "viz/scene/mesh_asset.h"
#include "viz/surface/mesh_ranges.h"
#include "viz/surface/mesh_shared.h"

namespace kino {

/// Where one mesh lies on the device.
struct PooledMesh {
    std::shared_ptr<const MeshAsset> asset;
    std::uint32_t format = KINO_FORMAT_STATIC;
    std::uint32_t first_vertex = 0;  ///< in vertices of its format
    std::uint32_t vertices = 0;
    std::uint32_t first_index = 0;
    std::uint32_t first_weight = 0;  ///< skinned meshes
    /// Skinned meshes: a sphere in bind space round the vertices that each joint moves, xyz and
    /// radius; negative: none.
    std::vector<glm::vec4> joint_spheres;
};

/// The device's copies of meshes and textures, one buffer a kind. Meshes keep their place while
/// they are wanted; gaps are taken by later ones.
class MeshPool {
  public:
    explicit MeshPool(gpu::Device& device) : device_(device) {}

    /// Brings in what is new and takes out what `wanted` lacks; makes buffers larger, or moves
    /// everything together, where there is no room. Fails for meshes that break their invariants
    /// (counts, indices) and where a buffer would pass the device's limits.
    [[nodiscard]] Result<void> keep(const std::vector<std::shared_ptr<const MeshAsset>>& wanted);
    /// Makes the textures of `materials` the ones on the device.
    [[nodiscard]] Result<void> keep_textures(const std::vector<Material>& materials);

    /// Null for a mesh that keep() was not given.
    [[nodiscard]] const PooledMesh* find(const MeshAsset* asset) const;
    /// Number + 1 of a material's texture, 0 for none.
    [[nodiscard]] std::uint32_t texture_of(std::size_t material) const;

    [[nodiscard]] const gpu::Buffer& vertices() const { return vertices_; }
    [[nodiscard]] const gpu::Buffer& indices() const { return indices_; }
    [[nodiscard]] const gpu::Buffer& weights() const { return weights_; }  ///< may be empty
    [[nodiscard]] const gpu::Buffer& texels() const { return texels_; }    ///< may be empty
    [[nodiscard]] std::uint64_t bytes() const;
    [[nodiscard]] const MeshRanges& vertex_ranges() const { return vertex_ranges_; }

  private:
    Result<void> place(const std::shared_ptr<const MeshAsset>& asset);
    Result<void> rebuild(const std::vector<std::shared_ptr<const MeshAsset>>& wanted);
    void write(PooledMesh& mesh);
    void remove(const PooledMesh& mesh);

    gpu::Device& device_;
    std::map<const MeshAsset*, PooledMesh> meshes_;
    gpu::Buffer vertices_;
    gpu::Buffer indices_;
    gpu::Buffer weights_;
    MeshRanges vertex_ranges_;
    MeshRanges index_ranges_;
    MeshRanges weight_ranges_;
    gpu::Buffer texels_;
    std::vector<std::shared_ptr<const Image<Rgba8>>> textures_;
    std::vector<std::uint32_t> texture_of_material_;
};

}  // namespace kino
