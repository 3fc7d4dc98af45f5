#include "sensor/filters/spatial_filter.h"

#include <array>

namespace kino {

std::span<const filters::Setting<SpatialParameters>> SpatialParameters::settings() {
    using P = SpatialParameters;
    static constexpr std::array kSettings = {
        filters::setting<&P::radius>("radius", 1, 4, "of the window, px"),
        filters::setting<&P::sigmas>("sigmas", 0.1, 100, "a step of so many sigmas is an edge"),
        filters::setting<&P::noise_per_m>("noise", 1e-5, 0.1, "sigma of inverse depth, 1/m"),
    };
    return kSettings;
}

Result<std::unique_ptr<SpatialFilter>> SpatialFilter::create(const SpatialParameters& parameters,
                                                             FilterOptions options) {
    KINO_TRY(filters::check_settings("spatial", parameters));
    return std::unique_ptr<SpatialFilter>(new SpatialFilter(parameters, options));
}

SpatialFilter::SpatialFilter(const SpatialParameters& parameters, FilterOptions options)
    : parameters_(parameters), run_(filters::choose(options.simd)), inverse_(parameters.radius) {}

void SpatialFilter::apply(const Image<float>& in, Image<float>& out) {
    inverse_.fill(in, run_);
    out.resize(in.width(), in.height());
    const int r = parameters_.radius;
    weights_.clear();
    offsets_.clear();
    for (int dy = -r; dy <= r; ++dy) {
        for (int dx = -r; dx <= r; ++dx) {
            const int square = dx * dx + dy * dy;
            if (square == 0 || square >= (r + 1) * (r + 1)) continue;
            weights_.push_back(1.0f -
                               static_cast<float>(square) / static_cast<float>((r + 1) * (r + 1)));
            offsets_.push_back(dy * inverse_.pitch() + dx);
        }
    }
    const filters::Window window = {.weights = weights_.data(),
                                    .offsets = offsets_.data(),
                                    .taps = static_cast<int>(weights_.size()),
                                    .inverse_threshold = static_cast<float>(
                                        1 / (parameters_.sigmas * parameters_.noise_per_m))};
    for (int y = 0; y < in.height(); ++y) {
        run_.smooth(window, inverse_.row(y), in.row(y), static_cast<std::size_t>(in.width()),
                    out.row(y));
    }
}

}  // namespace kino
