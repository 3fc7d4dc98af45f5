#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "base/image.h"

namespace kino::reference {

/// Geometry-aware framebuffer resizing (Yang, Sander, Lawrence, EGSR 2008), one pixel at a time in
/// double precision. Written from the paper's Eq. 1 and the contract of
/// viz/quality/framebuffer_lod.h, not from the shaders.

/// One pixel of the coarse picture.
struct LodSample {
    glm::dvec3 light{0};  ///< what is resized: colour, or colour over albedo
    double z = 0;         ///< metres; 0: nothing there
    glm::dvec2 slope{0};  ///< normal's x and y over its part towards the viewer
    std::uint32_t object = 0;
};

/// One pixel of the fine picture.
struct LodPixel {
    glm::dvec3 own{0};  ///< linear albedo, or the background's colour
    bool covered = true;
    double z = 0;
    glm::dvec3 normal{0, 0, -1};
    glm::dvec2 slope{0};
    std::uint32_t object = 0;
};

enum class LodMetric { depth, log_depth, plane };

struct LodRules {
    bool gauss = false;  ///< 4x4 coarse pixels instead of 2x2
    LodMetric metric = LodMetric::plane;
    double sigma_z = 0.02;
    double sigma_n = 0.25;
    bool fine_grained = true;
    bool objects = false;
    double fx = 1, fy = 1, cx = 0, cy = 0;  ///< of the fine picture
};

constexpr double kNoSigma = std::numeric_limits<double>::infinity();

/// Fine coordinate where coarse pixel `j` of `coarse` stands on an axis of `fine` pixels.
[[nodiscard]] double lod_place(int j, int fine, int coarse);
/// Fine texel that it is made from.
[[nodiscard]] int lod_texel(int j, int fine, int coarse);

/// The reconstructed linear colour of fine pixel (x, y). `doubt_bits` becomes -log2 of its
/// confidence, the sum of the weights; 0 where there is nothing.
[[nodiscard]] glm::dvec3 lod_reconstruct(const Image<LodSample>& coarse,
                                         const Image<LodPixel>& fine, int x, int y,
                                         const LodRules& rules, double* doubt_bits = nullptr);

/// Plain bilinear resizing at (x, y).
[[nodiscard]] glm::dvec3 lod_bilinear(const Image<LodSample>& coarse, int fine_width,
                                      int fine_height, int x, int y);

}  // namespace kino::reference
