#include "sensor/filters/temporal_filter.h"

#include <algorithm>
#include <array>

namespace kino {
namespace {
// Keeps the count of frames exact in float.
constexpr double kMostFrames = 65536;
}  // namespace

TemporalParameters TemporalParameters::librealsense() {
    const double delta_per_m = 20 / (0.075 * 575);
    return {.alpha = 0.4,
            .sigmas = delta_per_m / kKinectNoisePerM,
            .persistence = 2,
            .running = false,
            .soft = false};
}

std::span<const filters::Setting<TemporalParameters>> TemporalParameters::settings() {
    using P = TemporalParameters;
    static constexpr std::array kSettings = {
        filters::setting<&P::alpha>("alpha", 0, 1,
                                    "weight of a new frame once settled; 1: no filtering"),
        filters::setting<&P::sigmas>("sigmas", 0.1, 100000,
                                     "a change of so many sigmas starts anew"),
        filters::setting<&P::noise_per_m>("noise", 1e-5, 0.1, "sigma of inverse depth, 1/m"),
        filters::setting<&P::persistence>("persistence", 0, 250,
                                          "frames that a lost pixel keeps its value"),
        filters::setting<&P::running>("running", 0, 1,
                                      "1: the n-th frame weighs 1/n until that is alpha"),
        filters::setting<&P::soft>("soft", 0, 1, "1: larger changes weigh more"),
    };
    return kSettings;
}

Result<std::unique_ptr<TemporalFilter>> TemporalFilter::create(const TemporalParameters& parameters,
                                                               FilterOptions options) {
    KINO_TRY(filters::check_settings("temporal", parameters));
    return std::unique_ptr<TemporalFilter>(new TemporalFilter(parameters, options));
}

TemporalFilter::TemporalFilter(const TemporalParameters& p, FilterOptions options)
    : blend_{.alpha = static_cast<float>(p.alpha),
             .inverse_threshold = static_cast<float>(1 / (p.sigmas * p.noise_per_m)),
             .most =
                 static_cast<float>(p.alpha > 0 ? std::min(1 / p.alpha, kMostFrames) : kMostFrames),
             .persistence = p.persistence,
             .running = p.running,
             .soft = p.soft},
      run_(filters::choose(options.simd)) {}

void TemporalFilter::reset() {
    width_ = height_ = 0;
}

void TemporalFilter::apply(const Image<float>& in, Image<float>& out) {
    if (in.width() != width_ || in.height() != height_) {
        width_ = in.width();
        height_ = in.height();
        z_.assign(in.size(), 0.0f);
        frames_.assign(in.size(), 0.0f);
        unseen_.assign(in.size(), 0);
    }
    out.resize(width_, height_);
    run_.blend(blend_, in.data(), in.size(), {z_.data(), frames_.data(), unseen_.data()},
               out.data());
}

}  // namespace kino
