#pragma once

namespace kino {

/// Inverse of the standard normal distribution at p in (0, 1); beyond 6 deviations it stays there.
/// By bisection of erfc: slow and exact, for tables that are made once.
[[nodiscard]] double normal_quantile(double p);

}  // namespace kino
