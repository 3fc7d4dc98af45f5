#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <optional>

namespace kino {

enum class ZoomBlur : std::uint8_t {
    none,
    box,    ///< as wide as a block: bilinear between the blocks' centres
    spline  ///< twice: a quadratic B-spline
};

/// Draws the whole picture z times coarser along each side and enlarges it by copying pixels
/// (Mazuryk, Schmalstieg, Gervautz, "Zoom Rendering"). z = 1 without deflection: no pass, no bytes.
struct ZoomOptions {
    int z = 1;  ///< 1 .. 8
    ZoomBlur blur = ZoomBlur::box;
    friend bool operator==(const ZoomOptions&, const ZoomOptions&) = default;
};

}  // namespace kino
