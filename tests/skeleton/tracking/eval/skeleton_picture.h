#pragma once

#include <vector>

#include "base/body.h"
#include "base/image.h"
#include "skeleton/tracking/free_space.h"

namespace kino::test {

/// Depth as grey, parts in colour, truth as thin white bones, `found` as coloured ones (left red,
/// right green, inferred joints dark).
[[nodiscard]] Image<Rgba8> skeleton_picture(const Image<float>& depth_m,
                                            const Image<std::uint8_t>& part, const BodyFrame& truth,
                                            const BodyFrame& found, const PinholeFit& camera,
                                            int width);

[[nodiscard]] Image<Rgba8> skeleton_sheet(const std::vector<Image<Rgba8>>& pictures, int columns);

}  // namespace kino::test
