#pragma once

#include <optional>
#include <vector>

#include "base/image.h"

namespace kino {

/// The depth of a scene that does not change, at one time.
struct DriftPoint {
    double time_s = 0;      ///< since the first frame
    double distance_m = 0;  ///< median of the flat parts
    double scale = 1;       ///< depth over that of the beginning, median of the parts
    double sigma = 0;       ///< standard deviation of `scale`, from how the parts differ
    std::optional<double> temperature_c;  ///< where the recording has one
};

/// scale(t) = final_scale (1 - change exp(-t / tau_s)): a sensor that warms up.
struct WarmUp {
    double final_scale = 1;
    double change = 0;  ///< share of the depth
    double tau_s = 0;
};

struct DriftSeries {
    std::vector<DriftPoint> points;
    /// None where the scale does not change by more than four times what its noise explains.
    std::optional<WarmUp> warm_up;
    /// From the temperatures: share of the depth per kelvin, by a line; none without them.
    std::optional<double> per_kelvin;
};

/// Follows the depth of a still scene over a long recording: tiles of 32 x 32 px, nine tenths full,
/// each against its own mean of the first frames. Tiles that moved by more than 5 % since (somebody
/// walks by) are left out of that frame.
class DriftWatch {
  public:
    static constexpr int kTile = 32;
    static constexpr int kReferenceFrames = 10;

    /// Times rise; all images are of one size. Metres, 0 = none.
    void add(double time_s, const Image<float>& depth_m, std::optional<double> temperature_c = {});

    /// At most `points` points, each the mean of the frames in its share of the time.
    [[nodiscard]] DriftSeries series(int points = 200) const;

  private:
    std::vector<double> tiles_of(const Image<float>& depth_m) const;

    std::vector<double> reference_;  ///< of each tile; 0 where it has none
    std::vector<int> reference_counts_;
    int frames_ = 0;
    std::vector<DriftPoint> seen_;
};

/// The exponential that fits best; none as DriftSeries says.
[[nodiscard]] std::optional<WarmUp> fit_warm_up(const std::vector<DriftPoint>& points);

}  // namespace kino
