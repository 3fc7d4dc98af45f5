#pragma once

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// Mean structural similarity of the pictures' luma (Wang, Bovik, Sheikh, Simoncelli, "Image
/// quality assessment: from error visibility to structural similarity", 2004): Gaussian window of
/// 11x11 with deviation 1.5, K1 = 0.01, K2 = 0.03; windows that lie inside. 1: equal; smaller
/// pictures use one window over all. Fails where the sizes differ or a picture is empty.
[[nodiscard]] Result<double> ssim(const Image<Rgba8>& a, const Image<Rgba8>& b);

}  // namespace kino
