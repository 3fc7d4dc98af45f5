#pragma once

#include "viz/frame/renderer.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::test {

/// A wall, a leaning box, a thin post and a cube before a camera that looks along -z, `lights`
/// point lights between them. Materials 1 .. 4.
[[nodiscard]] Scene solid_scene(int lights);
[[nodiscard]] View solid_view(int width, int height);

/// The centre of every pixel moved by this much of a pixel.
[[nodiscard]] View moved_by(View view, double x_px, double y_px);

/// Where Vulkan's four samples lie, from a pixel's centre.
constexpr double kSamplePlaces[4][2] = {
    {-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};

/// sRGB-coded to linear and back, 0 .. 255.
[[nodiscard]] double linear_of(std::uint8_t coded);
[[nodiscard]] double coded_of(double linear);

/// The mean of pictures of the same size, of their light as shown; not rounded.
[[nodiscard]] std::vector<glm::dvec3> mean_coded(const std::vector<Image<Rgba8>>& pictures);

}  // namespace kino::test
