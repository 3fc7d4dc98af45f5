#pragma once

#include <cstdint>

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// Pixels near a silhouette, 1 each, else 0: within `radius_px` (in x and in y) of two neighbours
/// whose depths differ by more than `relative` of the nearer one, or of which only one is there.
[[nodiscard]] Image<std::uint8_t> depth_edge_band(const Image<float>& view_z_m, int radius_px = 2,
                                                  double relative = 0.05);
/// The same where depths are not known: neighbours whose luma differs by more than `step` of 255.
[[nodiscard]] Image<std::uint8_t> luma_edge_band(const Image<Rgba8>& picture, int radius_px = 2,
                                                 double step = 32);

struct BandError {
    double mse = 0;  ///< over r, g, b of the band's pixels, in (1/255)^2; 0 without pixels
    std::int64_t pixels = 0;
};
/// Fails where the sizes differ.
[[nodiscard]] Result<BandError> band_error(const Image<Rgba8>& a, const Image<Rgba8>& b,
                                           const Image<std::uint8_t>& band);

}  // namespace kino
