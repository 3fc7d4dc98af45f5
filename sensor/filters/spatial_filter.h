#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/error.h"
#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_settings.h"
#include "sensor/filters/inverse_depth.h"

namespace kino {

struct SpatialParameters {
    int radius = 2;                         ///< of the square window, 1 to 4 px
    double sigmas = 6;                      ///< a step of so many sigmas is an edge, 0.1 to 100
    double noise_per_m = kKinectNoisePerM;  ///< sigma of inverse depth, 1/m, 0.00001 to 0.1
    static std::span<const filters::Setting<SpatialParameters>> settings();
};

/// Averages each reading with its window in inverse depth. A neighbour that differs by d weighs
/// (1 - (d / (sigmas * noise))^2) times (1 - (distance / (radius + 1))^2), 0 where that is
/// negative: nothing beyond the edge threshold has any weight, so edges stay where they are, bit
/// for bit, and a step exactly at the threshold is an edge. Planes stay planes. Never fills a pixel
/// without a reading, never removes one; the result lies between the readings that went in.
class SpatialFilter : public DepthFilter {
  public:
    [[nodiscard]] static Result<std::unique_ptr<SpatialFilter>> create(
        const SpatialParameters& parameters = {}, FilterOptions options = {});

    [[nodiscard]] std::string_view name() const override { return "spatial"; }
    void apply(const Image<float>& in, Image<float>& out) override;

  private:
    SpatialFilter(const SpatialParameters& parameters, FilterOptions options);

    SpatialParameters parameters_;
    const filters::Functions& run_;
    filters::InverseDepth inverse_;
    std::vector<float> weights_;
    std::vector<std::ptrdiff_t> offsets_;
};

}  // namespace kino
