#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/error.h"
#include "viz/scene/material.h"
#include "viz/scene/mesh_asset.h"

namespace kino {

/// A mesh of a rigged character.
struct AvatarPart {
    std::shared_ptr<const MeshAsset> mesh;  ///< its joints count into AvatarRig::joints
    std::uint32_t material = 0;             ///< index into AvatarRig::materials, plus one; 0: none
};

/// A rigged character and which of its joints are whose. Object space: metres, y up, at rest it
/// stands on y = 0 and faces +z, its left is +x.
struct AvatarRig {
    std::string name;
    std::vector<AvatarPart> parts;
    std::vector<MeshJoint> joints;  ///< parents first
    std::vector<Material> materials;
    /// Rig joint of each joint of a body; -1: the rig has none, and its parent's does for it.
    std::array<int, kJointCount> of_joint{};
    std::vector<std::string> notes;  ///< what was mended or guessed, for the user
};

/// The rigs that are compiled in: name and sentence, a line each.
[[nodiscard]] std::string list_of_avatars();

/// A compiled-in rig by its name, or a glTF file (checked before tinygltf sees it; bones are
/// recognised by common names: Mixamo, VRM, Blender, makehuman). Fails for files that cannot be
/// had, have no skin, or in which hips, spine or a whole limb cannot be found.
[[nodiscard]] Result<std::shared_ptr<const AvatarRig>> open_avatar(const std::string& name_or_file);

}  // namespace kino
