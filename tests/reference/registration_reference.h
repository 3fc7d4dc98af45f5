#pragma once

#include <glm/vec2.hpp>

#include "base/camera_model.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino::reference {

/// Registration in plain double with no tables between frames: what calibration/rig.cpp must come
/// close to. NaN or 0 as stated where there is nothing.
struct Registration {
    Image<double> depth_m;     ///< 0 = no reading
    Image<glm::dvec2> uv;      ///< exact, unclamped, hidden pixels included; NaN = none
    Image<double> z_in_color;  ///< of each depth pixel in the picture, m; 0 = none
    /// As uv and z_in_color, but also of depth pixels whose place lies outside the picture.
    Image<glm::dvec2> place;
    Image<double> place_z;
    Image<std::uint8_t> hidden;      ///< 1 where the occlusion test refuses the colour
    Image<double> depth_in_color_m;  ///< nearest wins, 0 = nothing
};

/// The rays of a camera's pixels, NaN where there is none; slow, so made once by the caller.
[[nodiscard]] Image<glm::dvec2> rays(const CameraModel& camera);

/// `depth_rays` = rays(rig.depth). The rig must have a colour camera.
[[nodiscard]] Registration register_depth(const RigParameters& rig,
                                          const Image<glm::dvec2>& depth_rays,
                                          const DepthFrame& frame,
                                          double occlusion_margin_m = 0.03);

/// The same picture with every reading drawn as the piece of surface that it stands for, in double
/// and pixel by pixel: what calibration/registration_splat.h describes, without its tables.
/// `exact` = register_depth() of the same rig and frame.
struct SplatPicture {
    Image<double> depth_in_color_m;
    Image<std::uint8_t> hidden;  ///< as in Registration, against this picture; 1 also for backs
};
[[nodiscard]] SplatPicture splat_depth(const RigParameters& rig,
                                       const Image<glm::dvec2>& depth_rays,
                                       const Registration& exact, double occlusion_margin_m = 0.03);

}  // namespace kino::reference
