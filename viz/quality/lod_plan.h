#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kino {

/// A part of the shading that may be resized, as measured: shading it at every pixel costs
/// `cost_ns` a pixel, resized cost_ns / r^2; it then adds the squared error
/// `error` r^exponent (0 at r = 1, where nothing is resized).
struct LodComponent {
    std::string name;
    double cost_ns = 0;   ///< at least 0
    double error = 0;     ///< at least 0
    double exponent = 2;  ///< above 0
};

/// Resizing factors that a plan chooses from, in ascending order; 1: evaluated at every pixel.
[[nodiscard]] std::span<const double> lod_plan_levels();

struct LodPlan {
    std::vector<double> r;  ///< one for each component
    double cost_ns = 0;     ///< with the reconstruction, if anything is resized
    double error = 0;
    bool within_budget = false;
    [[nodiscard]] bool resizes() const;
};

/// What resizing costs beside the components.
enum class LodChain : std::uint8_t {
    at_once,  ///< everything is brought to full size together: one reconstruction
    nested    ///< each factor is brought to the next finer one, whose picture is 1/r^2 as large
};

/// Cost and error of given factors.
[[nodiscard]] LodPlan price_lod_plan(std::span<const LodComponent> components,
                                     std::vector<double> r, double budget_ns,
                                     double reconstruction_ns, LodChain chain = LodChain::at_once);

/// Which components to resize, and how far, so that all together cost at most `budget_ns` a pixel
/// with the least error. Lagrange's condition gives each an unbounded
///   r_e = (2 lambda K_e / (p_e a_e))^(1 / (p_e + 2)),
/// lambda by bisection, for every split into resized and whole ones; the nearest levels are then
/// bettered two components at a time. At most ten components. Where nothing fits the budget,
/// `within_budget` is false and the plan is a cheap one.
/// `levels` ascend from 1.
[[nodiscard]] LodPlan plan_lod(std::span<const LodComponent> components, double budget_ns,
                               double reconstruction_ns,
                               std::span<const double> levels = lod_plan_levels(),
                               LodChain chain = LodChain::at_once);

/// The same with factors r0 2^m, r0 of 1.25, 1.5 ... 4, beside 1: coarser guides can then be picked
/// from finer ones. Priced as a nested chain.
[[nodiscard]] LodPlan plan_nested_lod(std::span<const LodComponent> components, double budget_ns,
                                      double reconstruction_ns);

/// Least squares of t = K / r^2 + C, each time weighted by its inverse.
struct LodTimeFit {
    double k_ms = 0;
    double c_ms = 0;
};
/// `r` and `ms` are as long and hold at least two different factors.
[[nodiscard]] LodTimeFit fit_lod_time(std::span<const double> r, std::span<const double> ms);

}  // namespace kino
