#pragma once

#include <string>
#include <vector>

#include "base/image.h"

namespace kino::test {

/// Depth as a shaded grey picture of width x 3/4 width, whatever its own size; labels 1..6 in
/// colours.
[[nodiscard]] Image<Rgba8> label_picture(const Image<float>& depth_m,
                                         const Image<std::uint8_t>& labels, int width);

/// Pictures of one size side by side, `columns` a row, on white with a line between.
[[nodiscard]] Image<Rgba8> contact_sheet(const std::vector<Image<Rgba8>>& pictures, int columns);

}  // namespace kino::test
