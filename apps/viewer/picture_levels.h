#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "viz/quality/framebuffer_lod.h"

namespace kino {

/// One way to draw a whole picture, dear and good or cheap and poor.
struct PictureLevel {
    double lod = 1;  ///< resizing factor of the light
    Reconstruction reconstruction = Reconstruction::geometry_aware;
    int zoom = 1;      ///< pixels of the screen along a side of a drawn one
    double error = 0;  ///< mean FLIP of the final picture

    /// "light 1/2, picture 1/2"; "full".
    [[nodiscard]] std::string name() const;
    friend bool operator==(const PictureLevel&, const PictureLevel&) = default;
};

/// The least resizing factor above 1 that is offered.
constexpr double kLeastResizing = 1.125;

/// What is offered, best first. `staged`: light can be resized on its own.
[[nodiscard]] std::vector<PictureLevel> picture_levels(bool staged, int most_zoom);

/// Mean FLIP of light that is shaded r times coarser: of the worst scene in
/// docs/accuracy/framebuffer-lod.csv and governor.csv, between its r by the logarithm of r; 0 for
/// r = 1. Guided: fine-grained; bilinear: light and surface colour together.
[[nodiscard]] double lod_error(double r, Reconstruction reconstruction);

/// Mean FLIP of a picture that is drawn z times coarser and enlarged: of the worst scene in
/// docs/accuracy/zoom.csv and governor.csv, between its z by the logarithm of z; 0 for z = 1.
[[nodiscard]] double zoom_error(int z);

/// Of both together: their sum, with light coarser by the root of z than it is, for in a coarse
/// picture it loses more. Never less than was measured.
[[nodiscard]] double picture_error(const PictureLevel& level);

/// Pixels that are drawn, and light samples that are shaded, of a picture of `size`, both as shares
/// of its pixels.
struct PictureShare {
    double drawn = 1;
    double shaded = 1;
};
[[nodiscard]] PictureShare share_of(const PictureLevel& level, glm::ivec2 size);

}  // namespace kino
