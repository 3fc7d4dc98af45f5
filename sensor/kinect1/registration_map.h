#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "base/image.h"
#include "sensor/kinect1/factory_data.h"

namespace kino::kinect1 {

/// Where the device's own tables put a depth pixel in the 640x480 colour image, without the
/// rounding to whole pixels that registration in hardware or libfreenect does.
class RegistrationMap {
  public:
    static constexpr int kWidth = 640;
    static constexpr int kHeight = 480;

    RegistrationMap(const RegistrationBlock& block, const RegistrationPadding& padding,
                    const ZeroPlane& plane);

    /// Pixel (x, y) of the depth image, at z_m > 0 along the optical axis, to the colour image;
    /// pixel centres at integers. libfreenect registration.c:
    ///   x' = x + dx(x, y) + 1 + 0.375 + D/(2p) (1 - R/z),  y' = y + dy(x, y) + 1 - start lines
    /// whose whole part is the colour pixel, which is why half a pixel is taken off here.
    [[nodiscard]] glm::dvec2 at(int x, int y, double z_m) const;

    /// The polynomial's displacement of a pixel, px.
    [[nodiscard]] glm::dvec2 displacement(int x, int y) const { return table_.at(x, y); }

  private:
    Image<glm::dvec2> table_;
    double start_lines_;
    double color_shift_px_;  ///< D/(2p): what infinite distance shifts against the zero plane
    double reference_m_;
};

}  // namespace kino::kinect1
