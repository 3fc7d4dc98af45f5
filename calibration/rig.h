#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino {

/// A point in the colour image in fixed point: value / 2^kUvFractionBits pixels, pixel centres at
/// integers. 1/16 px keeps 16 bits enough for 4096 px wide colour; rounding costs at most 0.031 px
/// an axis. Points in the outer half of a border pixel are moved to that pixel's centre, which any
/// sampler that clamps to the edge reads as the same colour.
struct ColorUv {
    std::uint16_t u = 0xFFFF;
    std::uint16_t v = 0xFFFF;
    [[nodiscard]] bool valid() const { return u != 0xFFFF; }
    friend bool operator==(const ColorUv&, const ColorUv&) = default;
};
constexpr int kUvFractionBits = 4;

/// One depth frame put to work: what the Rig hands to everyone above it.
struct RegisteredDepth {
    /// Metres along the optical axis of the depth camera; 0 = no reading.
    Image<float> depth_m;
    /// Where each depth pixel lies in the colour image; invalid where there is no reading, no
    /// colour camera, the point falls outside, or something nearer hides it from that camera.
    Image<ColorUv> uv;
    /// The depth frame seen from the colour camera, metres, 0 = nothing there; nearest wins. How
    /// many colour pixels a depth pixel fills is RigOptions::coverage. Empty unless the Rig has a
    /// colour camera.
    Image<float> depth_in_color_m;
};

/// The x and y of a pixel's viewing ray at z = 1: P = z * (x, y, 1), distortion removed.
struct RayXy {
    float x = 0;
    float y = 0;
};

/// Which pixels of the colour camera's picture a depth reading is drawn into (docs/calibration.md).
enum class Coverage : std::uint8_t {
    nearest,   ///< the one it falls into: holes wherever colour is finer or a surface is slanted
    bilinear,  ///< the up to four around its place
    splat      ///< all that the piece of surface behind the depth pixel covers, each at its depth
};

struct RigOptions {
    /// Colour is refused where the point lies this far, plus two quantisation steps, behind the
    /// nearest one seen there. "There" is a colour pixel, or a square of as many as one depth pixel
    /// covers at equal range (focal lengths' ratio less 0.1, rounded up): a surface seen by a finer
    /// colour camera must not let what is behind it shine through between its points.
    double occlusion_margin_m = 0.03;
    bool occlusion_test = true;
    /// False: the portable code even where the processor has AVX2. Same bits, more time.
    bool simd = true;
    /// With `splat`, the occlusion test compares with all of the nearer surface, pixel by pixel,
    /// and colour is also refused where the colour camera sees a surface's other side.
    Coverage coverage = Coverage::nearest;
    /// Holes of up to this many pixels of depth_in_color_m that one surface encloses are closed
    /// (calibration/registration_holes.h). 0: nothing is made up.
    int fill_holes_px = 0;
    /// 1, 2, 4 or 8: every how many pixels, each way, a ray is kept; bilinear interpolation gives
    /// the others, off by less than 0.1 depth pixel (calibration/registration_rays.h).
    int ray_table_step = 1;
};

/// The one owner of depth-to-colour registration: built once per calibration, then used for every
/// depth frame by one thread at a time. Reuses its tables and the caller's buffers; after the
/// first frame nothing is allocated.
class Rig {
  public:
    /// Fails where validate(parameters) does, for colour wider or higher than ColorUv can say, and
    /// for options outside what RigOptions says.
    [[nodiscard]] static Result<Rig> create(RigParameters parameters, RigOptions options = {});
    ~Rig();
    Rig(Rig&&) noexcept;
    Rig& operator=(Rig&&) noexcept;

    [[nodiscard]] const RigParameters& parameters() const;

    /// Fills `out`. Linear raw 0 and 65535, disparity 2047 and above, and everything outside the
    /// parameters' range are no reading. Fails if the frame's size is not the depth camera's or its
    /// unit is not a positive number.
    [[nodiscard]] Result<void> register_depth(const DepthFrame& frame, RegisteredDepth& out);

    /// Rays of the depth camera, one a pixel; NaN where the distortion has no inverse.
    [[nodiscard]] const Image<RayXy>& depth_rays() const;

    /// Size of one depth quantisation step at z metres: 0.00307 z^2 m for a Kinect v1 (kinect
    /// sensors triangulate; Khoshelham & Elberink 2012), used by edge and occlusion tests.
    [[nodiscard]] static float quantisation_step_m(float z_m) { return 0.00307f * z_m * z_m; }

  private:
    struct State;
    explicit Rig(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
