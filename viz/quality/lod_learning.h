#pragma once

#include <span>
#include <string>

#include "viz/quality/lod_plan.h"

namespace kino {

/// What was measured of one component, for learning its place in a plan.
struct LodSamples {
    std::string name;
    /// Frame times of the same frames with the component and with a constant in its place.
    std::span<const double> ms_with;
    std::span<const double> ms_without;
    double pixels = 0;  ///< of such a frame
    /// Mean squared errors of the picture where the component alone was resized by r, each above 1.
    std::span<const double> r;
    std::span<const double> mse;
};

/// K_e is the median of the paired differences of time, a_e and p_e the least squares of
/// log(mse) = log(a) + p log(r), p held to [0.25, 4]. Where no error is above 0 the component is
/// free to resize (a_e = 0).
[[nodiscard]] LodComponent learn_lod_component(const LodSamples& samples);

/// Follows a component's error while a plan is in use, from pixels that are also shaded in full.
class LodDrift {
  public:
    explicit LodDrift(LodComponent learned) : learned_(std::move(learned)) {}
    /// The squared error that those pixels showed at factor r, above 1.
    void add(double r, double mse);
    /// The component with a_e as it is now.
    [[nodiscard]] LodComponent current() const;
    /// True where a_e has changed by more than `factor`: the plan is to be made anew.
    [[nodiscard]] bool drifted(double factor = 2) const;

  private:
    LodComponent learned_;
    double log_ratio_ = 0;  ///< mean of log(seen / predicted), newer ones counting more
    bool any_ = false;
};

}  // namespace kino
