#pragma once

#include <memory>

#include "viz/scene/scene_file.h"

namespace kino {

/// A shape of a scene file in its size; not gltf.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_stage_shape(SceneShape shape,
                                                                const glm::dvec3& size_m);

/// A ball of diameter 1 with few triangles, for lights that are to be seen.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_bead();
/// The same for lights that are seen as a few pixels: eight triangles.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_spark();
/// A rod of diameter and length 1 along y, centred, with few triangles.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_stroke();

}  // namespace kino
