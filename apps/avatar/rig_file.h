#pragma once

#include <string>

#include "apps/avatar/avatar_rig.h"
#include "viz/surface/assets/gltf_model.h"

namespace kino {

/// A rig of a glTF model: its meshes as they are at rest, turned to face +z, one part a material,
/// its bones without scale. `where` names it in errors.
[[nodiscard]] Result<AvatarRig> rig_of_model(const GltfModel& model, const std::string& where);

}  // namespace kino
