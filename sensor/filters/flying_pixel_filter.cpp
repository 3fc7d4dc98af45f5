#include "sensor/filters/flying_pixel_filter.h"

#include <array>
#include <cmath>
#include <numbers>

namespace kino {

std::span<const filters::Setting<FlyingPixelParameters>> FlyingPixelParameters::settings() {
    using P = FlyingPixelParameters;
    static constexpr std::array kSettings = {
        filters::setting<&P::steps>("steps", 0, 50,
                                    "jump that is no surface, sensor steps of 0.00307 1/m"),
        filters::setting<&P::angle_deg>("angle", 0, 89, "steepest surface that is kept, degrees"),
        filters::setting<&P::support>("support", 0, 8, "neighbours of eight that must agree"),
        filters::setting<&P::focal_px>("focal", 0, 100000,
                                       "focal length, px; 0: 0.893 of the width"),
    };
    return kSettings;
}

Result<std::unique_ptr<FlyingPixelFilter>> FlyingPixelFilter::create(
    const FlyingPixelParameters& parameters, FilterOptions options) {
    KINO_TRY(filters::check_settings("flying", parameters));
    return std::unique_ptr<FlyingPixelFilter>(new FlyingPixelFilter(parameters, options));
}

FlyingPixelFilter::FlyingPixelFilter(const FlyingPixelParameters& parameters, FilterOptions options)
    : parameters_(parameters), run_(filters::choose(options.simd)) {}

void FlyingPixelFilter::apply(const Image<float>& in, Image<float>& out) {
    const int width = in.width();
    inverse_.fill(in, run_);
    out.resize(width, in.height());
    const double focal =
        parameters_.focal_px > 0 ? parameters_.focal_px : kKinectFocalShare * width;
    const double slope = std::tan(parameters_.angle_deg * std::numbers::pi / 180) / focal;
    const filters::Support support = {
        .pitch = inverse_.pitch(),
        .step = static_cast<float>(parameters_.steps * kKinectStepPerM),
        .slope = static_cast<float>(slope),
        .minimum = parameters_.support};
    for (int y = 0; y < in.height(); ++y) {
        run_.support(support, inverse_.row(y), in.row(y), static_cast<std::size_t>(width),
                     out.row(y));
    }
}

}  // namespace kino
