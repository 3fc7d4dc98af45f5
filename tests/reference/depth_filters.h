#pragma once

#include <vector>

#include "base/image.h"

namespace kino::reference {

/// The depth filters in plain double, one pixel at a time, written from their description and not
/// from the fast code. Metres, 0 = no reading; everything outside 1 mm to 1 km is no reading.
/// Steps are 0.00307 1/m of inverse depth, `noise` is in the same unit.
[[nodiscard]] Image<double> flying_pixels(const Image<float>& in, double steps, double angle_deg,
                                          int support, double focal_px);
[[nodiscard]] Image<double> spatial(const Image<float>& in, int radius, double sigmas,
                                    double noise);
[[nodiscard]] Image<double> fill_holes(const Image<float>& in, int gap, double steps,
                                       double angle_deg, double focal_px, int edge,
                                       bool background);
[[nodiscard]] Image<double> decimate(const Image<float>& in, int factor, double steps,
                                     int readings);

/// Keeps every frame of its pixels' history instead of a running state.
class Temporal {
  public:
    struct Parameters {
        double alpha = 0.15, sigmas = 4.5, noise = 0.0017;
        int persistence = 2;
        bool running = true, soft = true;
    };
    explicit Temporal(const Parameters& parameters) : parameters_(parameters) {}
    /// All frames have one size.
    [[nodiscard]] Image<double> next(const Image<float>& in);

  private:
    Parameters parameters_;
    std::vector<Image<float>> frames_;
};

/// librealsense's post-processing with its published defaults, after its description and sources
/// (2.56, src/proc): for comparison only, nothing of ours is built on it.
namespace librealsense {

/// Recursive, edge-preserving: left to right, right to left, down, up, `magnitude` times. `values`
/// are depth units or pixels of disparity, 0 = nothing; `delta` is in the same unit.
void spatial(Image<double>& values, double alpha = 0.5, double delta = 20, int magnitude = 2);
/// The exponential mean with persistence "valid in 2 of the last 4 frames".
class Temporal {
  public:
    explicit Temporal(double alpha = 0.4, double delta = 20) : alpha_(alpha), delta_(delta) {}
    void next(Image<double>& values);

  private:
    double alpha_, delta_;
    Image<double> last_;
    Image<std::uint8_t> seen_;  // of the last eight frames, the newest is bit 0
};
/// "Farthest from around": the largest of the five neighbours above, below and to the left, in
/// scan order and in place, so that it runs to the right through holes of any width.
void fill_holes(Image<double>& metres);
/// Median of the readings of a block up to factor 3, their mean above.
[[nodiscard]] Image<double> decimate(const Image<double>& metres, int factor = 2);

}  // namespace librealsense
}  // namespace kino::reference
