#pragma once

#include <memory>
#include <span>

#include "base/error.h"
#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_settings.h"
#include "sensor/filters/inverse_depth.h"

namespace kino {

/// Two neighbours lie on one surface if their inverse depths differ by at most
/// steps * 0.00307 + tan(angle) / (f z): as depths, steps * 0.00307 z^2 + tan(angle) z / f.
struct FlyingPixelParameters {
    double steps = 3;       ///< sensor steps of 0.00307 1/m, 0 to 50
    double angle_deg = 80;  ///< steepest surface that is kept, 0 to 89 degrees off the axis
    int support = 2;        ///< of eight neighbours that must lie on the pixel's surface, 0 to 8
    double focal_px = 0;    ///< of the depth camera, 0 to 100000; 0: 0.893 of the width
    static std::span<const filters::Setting<FlyingPixelParameters>> settings();
};

/// Removes readings that hang between two surfaces: those that are nearer than one neighbour and
/// farther than the opposite one by more than a surface could slope, and those that too few
/// neighbours agree with. Never changes a reading that stays. An object one pixel wide stays (it is
/// nearer, or farther, than both sides), its end pixels and a single pixel do not unless `support`
/// is lower.
class FlyingPixelFilter : public DepthFilter {
  public:
    [[nodiscard]] static Result<std::unique_ptr<FlyingPixelFilter>> create(
        const FlyingPixelParameters& parameters = {}, FilterOptions options = {});

    [[nodiscard]] std::string_view name() const override { return "flying"; }
    void apply(const Image<float>& in, Image<float>& out) override;

  private:
    FlyingPixelFilter(const FlyingPixelParameters& parameters, FilterOptions options);

    FlyingPixelParameters parameters_;
    const filters::Functions& run_;
    filters::InverseDepth inverse_{1};
};

}  // namespace kino
