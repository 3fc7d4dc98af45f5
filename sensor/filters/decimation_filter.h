#pragma once

#include <memory>
#include <span>

#include "base/camera_model.h"
#include "base/error.h"
#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_kernel.h"
#include "sensor/filters/filter_settings.h"

namespace kino {

struct DecimationParameters {
    int factor = 2;    ///< pixels a side that become one, 1 to 8; librealsense: 2 to 8, default 2
    double steps = 3;  ///< readings this far from the median do not count, steps of 0.00307 1/m
    int readings = 1;  ///< that a block must hold to give one, 1 to 64
    static std::span<const filters::Setting<DecimationParameters>> settings();
};

/// Makes one pixel of each block of factor x factor (the last ones may be cut by the border): the
/// mean in inverse depth of the readings near the block's lower median. So the answer lies on one
/// of the surfaces in the block, never between two; half of a block is enough for the nearer
/// surface, so of a block of two by two an object one pixel wide stays. (librealsense: the median
/// up to factor 3, above it the mean of all, which hangs between surfaces.)
class DecimationFilter : public DepthFilter {
  public:
    [[nodiscard]] static Result<std::unique_ptr<DecimationFilter>> create(
        const DecimationParameters& parameters = {}, FilterOptions options = {});

    [[nodiscard]] std::string_view name() const override { return "decimate"; }
    void apply(const Image<float>& in, Image<float>& out) override;
    [[nodiscard]] int reduction() const override { return parameters_.factor; }

  private:
    DecimationFilter(const DecimationParameters& parameters, FilterOptions options);
    [[nodiscard]] float reduce(float* readings, int count) const;
    [[nodiscard]] float block(const Image<float>& in, int x, int y) const;

    DecimationParameters parameters_;
    const filters::Functions& run_;
    float threshold_;
};

/// The camera that sees the decimated picture: pixel centres are the blocks' centres.
[[nodiscard]] CameraModel decimated(const CameraModel& camera, int factor);

}  // namespace kino
