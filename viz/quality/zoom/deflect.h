#pragma once

#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "base/image.h"
#include "viz/scene/view.h"

namespace kino {

/// How a picture is brought to a pose newer than the one it was drawn for, cheapest first.
enum class DeflectForm : std::uint8_t {
    pan,         ///< by whole pixels, as the centre of the reference plane moves
    homography,  ///< as the whole reference plane moves; exact where a camera only turns
    depth_warp   ///< each pixel by its own depth
};

struct DeflectOptions {
    DeflectForm form = DeflectForm::pan;
    /// Drawn beyond each side of the picture, px of the picture; what is farther out is the
    /// border's pixel.
    int guard_px = 0;
    /// View depth of the reference plane; 0: the harmonic mean of what was drawn, so that errors of
    /// the near and of the far cancel.
    double reference_z_m = 0;
    double nearest_z_m = 0.1;  ///< nearer points move as if they were there
    /// The view as it is now, of the picture's size; called once, just before the copy. A pose that
    /// is none leaves the picture where it is.
    std::function<View()> newest;
};

/// Takes pixels of `to` to those of `from`'s picture that show the same points of the plane at view
/// depth 1 / `inverse_z` before `from`; 0: infinitely far (Hartley, Zisserman, "Multiple View
/// Geometry", 13.1). Homogeneous, pixel centres at integers.
[[nodiscard]] glm::dmat3 plane_homography(const View& to, const View& from, double inverse_z);

/// `wanted`, turned no more than 20 degrees away from `drawn`; `drawn` itself where `wanted` is no
/// number.
[[nodiscard]] View deflectable(const View& wanted, const View& drawn);

/// By how much the centre of `drawn`'s picture moves until it is `shown`'s: whole pixels, to be
/// added to the pixel shown to find the one drawn. Both of one size.
[[nodiscard]] glm::ivec2 pan_of(const View& shown, const View& drawn, double inverse_z);

/// 1/z of each pixel, at most 1 / `nearest_z_m`; 0 where nothing is. Returns the mean.
double invert_depths(const ImageView<const float>& view_z_m, double nearest_z_m,
                     Image<float>& inverse_z);

/// What is copied: a picture, the view that it was drawn for, and 1/z of its pixels (or nothing).
struct DrawnPicture {
    ImageView<const std::uint32_t> picture;
    View view;
    ImageView<const float> inverse_z;
};

/// Fills `out` with what `shown` sees of `drawn`, each pixel through its depth (two steps of a
/// fixed point; where that does not settle, the farther of the two), or through the plane at
/// `inverse_z` if the picture has no depths. `smooth`: bilinear, else the nearest pixel. Returns
/// how many pixels lay outside of what was drawn; they get the border's.
std::int64_t deflect(const DrawnPicture& drawn, const View& shown, double inverse_z, bool smooth,
                     const ImageView<std::uint32_t>& out);
/// The same bits without SIMD.
std::int64_t deflect_portable(const DrawnPicture& drawn, const View& shown, double inverse_z,
                              bool smooth, const ImageView<std::uint32_t>& out);

}  // namespace kino
