#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "viz/scene/mesh_asset.h"
#include "viz/surface/assets/gltf_accessor.h"

namespace kino {

/// How a primitive becomes a mesh.
struct GltfMeshOptions {
    std::string name;
    std::string where;
    /// The skin's order of joints: new number of the file's joint j. Empty: not skinned.
    std::vector<std::uint16_t> joint_order;
};

/// Triangles of one primitive with everything that MeshAsset asks for: normals made flat where the
/// file has none, weights of the strongest four joints, brought to a sum of one. None for points
/// and lines. What was mended goes into `notes`.
[[nodiscard]] Result<std::optional<MeshAsset>> read_primitive(const tinygltf::Model& model,
                                                              const tinygltf::Primitive& primitive,
                                                              const GltfMeshOptions& options,
                                                              std::vector<std::string>& notes);

}  // namespace kino
