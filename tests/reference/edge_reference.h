#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "base/image.h"
#include "tests/reference/lod_reference.h"

namespace kino::reference {

/// Edges smoothed from a finished picture with one sample a pixel, in double precision, written
/// from the contracts of viz/quality/lod_samples.h and viz/frame/supersampled_stage.h.

/// What a sample, or a pixel's centre, shows.
struct EdgeSurface {
    glm::dvec3 own{0};  ///< albedo or the background's colour, linear
    bool covered = true;
    double z = 0;  ///< metres; not above 0 or no number: nothing there
    glm::dvec3 normal{0, 0, -1};
    std::uint32_t object = 0;
    glm::dvec3 emission{0};
};

struct EdgeRules {
    LodRules lod;  ///< metric, sigmas, fine_grained and the view
    double least_albedo = 0.0144;
    double exposure = 1;
    bool tone_map = true;
    bool as_shown = true;  ///< the mean of colours as shown, not of light
};

/// Vulkan's places of four samples, from a pixel's centre.
constexpr std::array<std::array<double, 2>, 4> kFourSamples = {
    {{-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}}};

/// By how much the samples of a pixel differ from its centre: above 1 it is an edge. The largest of
/// depth and normals in their limits; infinite where an object, or being there at all, differs.
[[nodiscard]] double edge_excess(const EdgeSurface& centre,
                                 const std::array<EdgeSurface, 4>& samples, double x, double y,
                                 const LodRules& rules);

/// Colour and alpha of an edge pixel. `picture` is linear light, `surface` what it shows.
[[nodiscard]] glm::dvec4 edge_color(const Image<glm::dvec3>& picture,
                                    const Image<EdgeSurface>& surface,
                                    const std::array<EdgeSurface, 4>& samples, int x, int y,
                                    const EdgeRules& rules);

}  // namespace kino::reference
