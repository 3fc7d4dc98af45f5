#pragma once

#include <cstdint>
#include <vector>

#include "base/frame.h"
#include "sensor/clip_video.h"
#include "sensor/description.h"

namespace kino {

/// Depth units of a decoded clip: 1/8 mm, far below the code's own steps (some millimetres), so
/// that decoding adds no staircase. 16 bits end at 8.19 m.
constexpr double kClipUnitsPerMetre = 8000;

/// Turns the pictures of a clip into raw depth, pixel by pixel of the video. Steps:
/// 1. v per pixel. rgb_sum: limited-range BT.601 to r, g, b, then the nearest point of the ramp
///    black-blue-cyan-white. Chroma comes at half size: it is interpolated, but only from cells
///    that resemble the pixel's own, so that a silhouette is not mixed with what lies behind.
/// 2. v < invalid_below is no reading.
/// 3. A pixel whose 5x5 neighbourhood spans more than edge_span in v, and which stands in the
///    middle of it (more than a quarter of the span from either end), lies on neither surface:
///    the codec's blur put it there. Dropped.
/// 4. Each v becomes the mean of those in its 5x5 neighbourhood that differ by at most
///    smooth_span (Lee 1983, the sigma filter): the code's steps and the codec's blocks go, edges
///    stay, no pixel appears or vanishes.
/// 5. z by the description's scale (ClipScale).
class ClipDepth {
  public:
    explicit ClipDepth(ClipDescription description);

    /// `out` gets the picture's size. Reuses its own scratch memory.
    void decode(const YuvPicture& picture, Image<std::uint16_t>& out);

  private:
    void read_codes(const YuvPicture& picture);
    void find_spans();
    void drop_smear();
    void smooth();

    ClipDescription description_;
    std::vector<std::uint16_t> units_;  ///< depth of each v in 1/16 of 1/765
    Image<std::int16_t> code_;          ///< v in 1/16 of 1/765, so 0..12240
    Image<std::int16_t> low_, high_, row_low_, row_high_;
    Image<std::int16_t> surface_;  ///< code_ of the valid pixels, with a margin all round
    std::vector<std::int32_t> sum_, count_;
};

}  // namespace kino
