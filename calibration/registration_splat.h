#pragma once

#include <cstdint>
#include <vector>

#include "calibration/registration_kernel.h"
#include "calibration/registration_rays.h"

namespace kino::registration {

/// One depth image as project() left it, row by row, and what is drawn from it.
struct Places {
    const float* depth_m;     ///< from the depth camera
    const float* u;           ///< exact place in the colour picture, px
    const float* v;           ///< px
    const float* z;           ///< metres from the colour camera, 0 = no place
    std::uint32_t* uv;        ///< kInvalid outside the picture
    std::uint32_t* key;       ///< bits of z inside the picture
    float* depth_in_color_m;  ///< the picture to draw, 0 = nothing
};

/// Every reading into the up to four colour pixels around its place; the nearest wins.
void draw_four_pixels(const Geometry& geometry, const Places& places, std::size_t n);

/// Draws a depth image into the colour camera's picture, each reading as large as the piece of
/// surface that it stands for.
///
/// A reading's piece is flat: 1/z is linear in the pixels of both cameras (pinhole model). Its
/// slope comes from those of the four neighbours that lie on the same surface; where there is none
/// on either side of an axis, the piece faces the depth camera along it. Projected, the piece is a
/// parallelogram around the reading's place. Every colour pixel whose centre it holds gets the
/// depth that the piece has there, and so does the pixel that the reading's place falls into; the
/// nearest wins. A piece ends half a depth pixel from its reading, so nothing bleeds over an edge.
///
/// Two neighbours are of one surface if their depths differ by at most three quantisation steps
/// plus what one pixel makes on a surface tilted by 80 degrees; or by 88 if one of the next pixels
/// along the line goes on straight in 1/z, within the same three steps.
class Splat {
  public:
    static constexpr double kUsualTiltDeg = 80;
    static constexpr double kSteepestTiltDeg = 88;
    /// How much further a piece reaches, in depth pixels, lest those of a bent surface leave gaps.
    static constexpr float kOverlap = 1.0f / 16;
    /// No piece reaches further than this many times the size of one that faces both cameras.
    static constexpr float kLargestPiece = 8;

    Splat() = default;
    /// `pixel_ratio`: colour pixels to a depth pixel at equal range.
    Splat(int width, int height, double depth_focal_px, double pixel_ratio);

    /// `table`: the depth camera's rays in the colour camera's axes. Replaces every key by the bits
    /// of what the reading's own piece has at the centre of its colour pixel, so that an occlusion
    /// test compares depths at one place. With `refuse_backs`, uv becomes kInvalid where the colour
    /// camera sees a piece from behind.
    void draw(const Geometry& geometry, const RayTable& table, const Places& places,
              bool refuse_backs);

  private:
    struct Piece;
    void link(const Places& places);
    [[nodiscard]] bool continues(const float* depth_m, std::size_t i, std::size_t next, int at,
                                 int size) const;
    void face_camera(const Geometry& geometry, const RayTable& table, const Places& places,
                     std::size_t i, int x, int y, Piece& piece) const;
    void draw_piece(const Geometry& geometry, const Places& places, std::size_t i, Piece piece,
                    bool refuse_back) const;

    int width_ = 0;
    int height_ = 0;
    float three_steps_ = 0;  // m at 1 m; in 1/z everywhere
    float usual_slope_ = 0;  // m from pixel to pixel at 1 m
    float steepest_slope_ = 0;
    float largest_reach_px_ = 0;
    std::vector<std::uint8_t> linked_;  // kRight, kDown
    std::vector<float> inverse_z_;
};

}  // namespace kino::registration
