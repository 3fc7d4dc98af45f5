#pragma once

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// How a pair of pictures is watched: pixels a degree of the visual field. The default is a picture
/// of 3840 pixels on 0.7 m seen from 0.7 m.
struct FlipOptions {
    double pixels_per_degree = 67.02064327658225;
};

/// What flicking between two pictures shows (Andersson, Nilsson, Akenine-Moeller, Oskarsson,
/// Astroem, Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020, for
/// pictures of 8 bits).
struct FlipResult {
    Image<float> map;  ///< 0: no difference is seen .. 1
    double mean = 0;
};

/// Alpha does not count. Swapping the pictures changes nothing. Fails where the sizes differ or a
/// picture is empty.
[[nodiscard]] Result<FlipResult> flip_error(const Image<Rgba8>& a, const Image<Rgba8>& b,
                                            const FlipOptions& options = {});

/// The map as a picture: black, blue, red, yellow, white in equal steps of error.
[[nodiscard]] Image<Rgba8> flip_picture(const FlipResult& result);

}  // namespace kino
