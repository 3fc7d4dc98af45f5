#pragma once

#include <glm/vec3.hpp>
#include <set>
#include <string>

#include "base/error.h"
#include "viz/surface/assets/gltf_model.h"

namespace kino::test {

/// How a made-up humanoid's bones are called.
enum class BoneNames { mixamo, vrm, blender, makehuman, unreal, none };

/// A person of boxes in a T-pose, 1.75 m, as a glTF file.
struct HumanoidFile {
    BoneNames names = BoneNames::mixamo;
    double unit = 1;                ///< 100: centimetres
    bool faces_back = false;        ///< -z instead of +z
    bool z_up = false;              ///< the bind pose; the root node turns it
    bool rigid = false;             ///< boxes hang on bones; one tiny triangle alone has a skin
    int weights = 2;                ///< joints a vertex, up to 8
    glm::dvec3 mesh_scale{1};       ///< rigid: of the boxes' nodes
    std::set<std::string> missing;  ///< "left hand", "spine", ...

    [[nodiscard]] std::string json() const;
    [[nodiscard]] Result<GltfModel> model() const;
};

}  // namespace kino::test
