#pragma once

#include <cstdint>
#include <filesystem>

#include "base/error.h"
#include "base/pose.h"
#include "viz/scene/scene.h"

namespace kino {

/// Writes every depth pixel with a reading as a point: PLY 1.0, binary little-endian, float x, y, z
/// in metres (world) and uchar red, green, blue (grey where the colour is not known). Returns the
/// number of points.
[[nodiscard]] Result<std::int64_t> write_ply(const std::filesystem::path& path,
                                             const DepthSurface& surface,
                                             const Pose& world_from_depth);

}  // namespace kino
