#pragma once

#include <glm/vec3.hpp>
#include <memory>

#include "apps/bench/stage_player.h"
#include "base/error.h"
#include "base/image.h"
#include "viz/scene/scene.h"

namespace kino::bench {

/// A node that stands at `at`, turned about an axis that is nearly upright.
[[nodiscard]] MeshNode standing_node(std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& at,
                                     double turn, std::uint32_t material, std::uint32_t id);

/// The mean, as shown, of side x side pictures with one sample a pixel, their centres on a square
/// grid within it.
[[nodiscard]] Result<Image<glm::dvec3>> mean_of_pictures(StagePlayer& player, const Scene& scene,
                                                         const View& view, int side);

/// Display light, 0 .. 1, coded as sRGB.
[[nodiscard]] double coded_srgb(double linear);

}  // namespace kino::bench
