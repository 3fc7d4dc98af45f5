#pragma once

#include <cstdint>

namespace kino {

enum class ZoomBlur : std::uint8_t {
    none,
    box,    ///< as wide as a block: bilinear between the blocks' centres
    spline  ///< twice: a quadratic B-spline
};

/// Who enlarges.
enum class ZoomPath : std::uint8_t {
    automatic,  ///< host on CPU devices, else fragment
    host,       ///< replicated in mapped memory, then copied to the picture
    fragment    ///< a pass over the picture
};

constexpr int kMaxZoom = 8;

/// Draws the whole picture z times coarser along each side and enlarges it by copying pixels
/// (Mazuryk, Schmalstieg, Gervautz, "Zoom Rendering"). z = 1 without deflection: no pass, no bytes.
struct ZoomOptions {
    int z = 1;  ///< 1 .. kMaxZoom; of a picture smaller than that, at most its shorter side
    ZoomBlur blur = ZoomBlur::box;
    ZoomPath path = ZoomPath::automatic;
    friend bool operator==(const ZoomOptions&, const ZoomOptions&) = default;
};

}  // namespace kino
