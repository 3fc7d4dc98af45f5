#pragma once

#include <vector>

namespace kino {

/// What may not be paired.
constexpr double kNoPair = 1e9;

/// Pairs rows with columns so that as many as possible are paired and, among those, the sum of
/// costs is least (Hungarian method with potentials, Kuhn 1955, Munkres 1957). `cost` by rows,
/// each >= 0 and below 1000, or kNoPair. Returns the column of each row, -1 if it has none.
[[nodiscard]] std::vector<int> assign(const std::vector<double>& cost, int rows, int columns);

}  // namespace kino
