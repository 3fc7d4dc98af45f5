#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace kino {

/// One setting of something that can be traded: what it costs and what it loses.
struct Level {
    double cost_ms = 0;
    double error = 0;  ///< mean FLIP that it adds to the final picture
};

/// For every part one level, such that the costs' sum is at most `budget_ms` and the errors' sum is
/// as low as it can be; among equals the cheapest. Exact, by merging the parts' non-dominated
/// sums; sums beyond 4,096 are thinned evenly by cost, which may lose a little. Where even the
/// cheapest levels exceed the budget, these. Levels with a cost or an error that is not finite are
/// never chosen unless a part has no other; every part needs a level.
[[nodiscard]] std::vector<std::size_t> choose_levels(std::span<const std::vector<Level>> parts,
                                                     double budget_ms);

/// Costs and errors of a choice, summed.
[[nodiscard]] Level sum_of(std::span<const std::vector<Level>> parts,
                           std::span<const std::size_t> choice);

}  // namespace kino
