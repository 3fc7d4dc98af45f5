#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "viz/scene/scene_file.h"

namespace kino {

/// A mesh that stands still, in stage space.
struct StandingMesh {
    std::shared_ptr<const MeshAsset> mesh;
    glm::dmat4 stage_from_object{1};
    std::uint32_t material = 0;  ///< as in MeshNode
    std::shared_ptr<const std::vector<glm::mat4>> pose;
};

/// Something that is drawn many times: an object that fits `size` and looks in turn.
struct StageProp {
    std::vector<StandingMesh> parts;       ///< about the origin
    std::vector<std::uint32_t> materials;  ///< in turn; empty: the parts' own
};

/// A scene file with everything it needs at hand: meshes made or loaded, materials in order.
struct StageSet {
    SceneFile file;
    std::vector<Material> materials;
    std::vector<StandingMesh> standing;
    std::vector<StageProp> props;  ///< one for each role; without parts where it has none
    /// Glowing materials for each swarm's and each role's trail palette.
    std::vector<std::vector<std::uint32_t>> swarm_glow, trail_glow;
    std::shared_ptr<const MeshAsset> bead;    ///< a ball of diameter 1
    std::shared_ptr<const MeshAsset> spark;   ///< the same for small ones
    std::shared_ptr<const MeshAsset> stroke;  ///< a rod of diameter and length 1 along y
};

/// A glowing thing is brighter than white, so that it stays bright beside what it lights.
inline constexpr float kStageGlow = 1.5f;

/// `folder`: where the files named in it are. Fails for files that cannot be had, and for more
/// materials than there may be.
[[nodiscard]] Result<StageSet> make_stage(SceneFile file, const std::filesystem::path& folder);

/// A bundled scene by its name, or a scene file.
[[nodiscard]] Result<StageSet> open_stage(const std::string& name_or_file);

/// Where each copy of a mesh stands: stage from object.
[[nodiscard]] std::vector<glm::dmat4> mesh_places(const SceneMesh& mesh);

/// Bits of Light::material_mask for names as in SceneLight::only.
[[nodiscard]] std::uint32_t material_mask(const SceneFile& file,
                                          const std::vector<std::string>& names);

}  // namespace kino
