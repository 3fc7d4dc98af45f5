#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/error.h"
#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_kernel.h"
#include "sensor/filters/filter_settings.h"

namespace kino {

struct TemporalParameters {
    /// Weight of a new frame once the mean has settled, 0 to 1: 1 is no filtering, 0 the mean of
    /// everything since the last jump (without `running`: the first reading for ever).
    double alpha = 0.15;
    double sigmas = 4.5;  ///< a change of so many sigmas is a jump and starts anew, 0.1 to 100000
    double noise_per_m = kKinectNoisePerM;  ///< sigma of inverse depth, 1/m, 0.00001 to 0.1
    int persistence = 1;                    ///< frames that a lost pixel keeps its value, 0 to 250
    /// The n-th frame after a jump weighs 1/n until that is less than alpha: noise falls at once.
    bool running = true;
    /// A change by the share u of a jump moves the weight by u^4 of the way to 1, so that slow
    /// motion is followed; else alpha holds up to the threshold.
    bool soft = true;

    /// librealsense's published defaults (doc/post-processing-filters.md): alpha 0.4, delta 20 (px
    /// of disparity, here of a Kinect's 75 mm and 575 px), the plain exponential mean. Its
    /// persistence 3, "valid in 2 of the last 4", keeps a pixel two frames at most.
    [[nodiscard]] static TemporalParameters librealsense();
    static std::span<const filters::Setting<TemporalParameters>> settings();
};

/// Averages over time, per pixel, in inverse depth. A reading that differs from the mean by the
/// threshold or more replaces it, bit for bit, so that a moving edge never smears; so the answer
/// never lies farther than the threshold from the newest reading. A pixel that loses its reading
/// keeps the mean for `persistence` frames and is then empty: nothing is ever shown where nothing
/// was seen for longer. A frame of another size starts anew. The pixels' memory is of the sensor,
/// not of the scene: after a seek or cut call reset().
class TemporalFilter : public DepthFilter {
  public:
    [[nodiscard]] static Result<std::unique_ptr<TemporalFilter>> create(
        const TemporalParameters& parameters = {}, FilterOptions options = {});

    [[nodiscard]] std::string_view name() const override { return "temporal"; }
    void apply(const Image<float>& in, Image<float>& out) override;
    void reset() override;

  private:
    TemporalFilter(const TemporalParameters& parameters, FilterOptions options);

    filters::Blend blend_;
    const filters::Functions& run_;
    int width_ = 0, height_ = 0;
    std::vector<float> z_, frames_;
    std::vector<std::int32_t> unseen_;
};

}  // namespace kino
