#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/error.h"

namespace kino {

/// A joint of a file: parents need not come first. Positions at rest, any unit, y roughly up.
struct FileBone {
    std::string name;
    int parent = -1;
    glm::dvec3 at{0};
};

/// Which bone is which joint of a body; -1: none. Known are the names of Mixamo, VRM, Blender
/// (Rigify), makehuman, Unreal and Cesium Man with their prefixes and marks of the side; where
/// names say nothing, the shape of the tree does: two longest ways down are legs, two longest ways
/// aside arms. Fails where hips, spine or a whole limb cannot be found; what was guessed goes into
/// `notes`.
[[nodiscard]] Result<std::array<int, kJointCount>> recognize_bones(std::span<const FileBone> bones,
                                                                   const std::string& where,
                                                                   std::vector<std::string>& notes);

}  // namespace kino
