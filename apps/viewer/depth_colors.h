#pragma once

#include <optional>

#include "base/image.h"

namespace kino {

struct DepthRange {
    float near_m = 0.5f;
    float far_m = 4;
};

/// The range that most of a picture's readings lie in (2nd to 98th of 100, of a sample); empty
/// without readings.
[[nodiscard]] std::optional<DepthRange> depth_range(const Image<float>& depth_m);

/// Near is warm and bright, far is cool and dark, lightness falling all the way, so that it reads
/// without colour vision, too. Nothing (0) is black. Outside the range the ends are kept.
[[nodiscard]] Rgba8 depth_color(float depth_m, const DepthRange& range);

/// `depth_m` in colours, reduced to out's size (nearest pixel).
void color_depth(const Image<float>& depth_m, const DepthRange& range, Image<Rgba8>& out);

/// Any picture reduced to out's size: the mean of nearest four.
void reduce_picture(const Image<Rgba8>& picture, Image<Rgba8>& out);

/// Infrared brightness as grey, reduced to out's size.
void reduce_infrared(const Image<std::uint16_t>& raw, int significant_bits, Image<Rgba8>& out);

}  // namespace kino
