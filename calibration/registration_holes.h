#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"

namespace kino::registration {

/// Closes holes that one surface encloses. A hole is a connected (by sides) set of empty pixels
/// that does not reach the picture's border; it is closed if it has at most `largest_px` of them
/// and a single plane (1/z linear in the pixels) passes within three quantisation steps of every
/// pixel on its rim. It then gets that plane's depth. What lies between a surface and another one
/// behind it has no such plane and stays empty, as does every larger hole.
class HoleFiller {
  public:
    void fill(Image<float>& depth_m, int largest_px);

  private:
    struct Pixel {
        int x, y;
    };
    /// Collects a hole from one of its pixels; false if it is too large or at the border.
    [[nodiscard]] bool collect(const Image<float>& depth_m, Pixel first, int largest_px);
    void close(Image<float>& depth_m) const;

    Image<std::uint8_t> seen_;
    std::vector<Pixel> hole_;
};

}  // namespace kino::registration
