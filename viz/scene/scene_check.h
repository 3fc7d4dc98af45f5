#pragma once

#include <string>

#include "viz/scene/scene_file.h"

namespace kino {

/// What no single value shows: names that are not there, pairs in the wrong order, directions
/// without length, paths that lead out of the folder, more lights or meshes than allowed. Where
/// `where#pointer` says.
[[nodiscard]] Result<void> check_scene_file(const SceneFile& file, const std::string& where);

}  // namespace kino
