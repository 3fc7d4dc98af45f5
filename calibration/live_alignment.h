#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// Is the calibration still good, while a picture runs: every Nth frame it looks at some of the
/// depth contours and where the strongest colour contours lie beside them. A light twin of
/// solve/edge_alignment.h: at most 1200 points, two pixels' steps, then single ones; 1 to 2 ms at
/// 640x480. One thread at a time.
class LiveAlignment {
  public:
    static constexpr int kEvery = 15;    ///< frames from look to look
    static constexpr int kReachPx = 10;  ///< farther than this is not found
    static constexpr int kLooks = 9;     ///< that the figure is the median of

    /// What is known of one camera and its frames goes: for another source.
    void reset();

    /// A frame; most are only counted. Depth in metres with its rays, `color` at the size that
    /// `rig.color` states. Frames without contours change nothing.
    void look(const Image<float>& depth_m, const Image<RayXy>& rays, const Image<Rgba8>& color,
              const RigParameters& rig);

    struct Figure {
        double dx_px = 0, dy_px = 0;  ///< where colour contours lie from depth contours
        double sharpness = 0;         ///< of the newest look, as EdgeAlignment's
        int looks = 0;                ///< behind it
        double ms = 0;                ///< that the newest look took
        [[nodiscard]] double off_px() const;
    };
    /// None until three looks found contours that stand out.
    [[nodiscard]] std::optional<Figure> figure() const;

    /// "colour 0.8 px from depth: good"; empty as long as there is no figure. Over 3 px it says
    /// that the calibration has slid.
    [[nodiscard]] std::string words() const;

    /// One look at once, whatever the count: none where fewer than 100 contour points are seen.
    [[nodiscard]] std::optional<Figure> look_now(const Image<float>& depth_m,
                                                 const Image<RayXy>& rays,
                                                 const Image<Rgba8>& color,
                                                 const RigParameters& rig);

  private:
    struct Place {
        int x = 0, y = 0;
    };
    void find_places(const Image<float>& depth_m, const Image<RayXy>& rays,
                     const RigParameters& rig);
    double score(const Image<Rgba8>& color, int dx, int dy) const;

    std::vector<Place> places_;
    std::vector<Figure> looks_;
    int frames_ = 0;
};

}  // namespace kino
