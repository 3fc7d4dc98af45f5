#include "skeleton/synthetic/normal_quantile.h"

#include <cmath>

namespace kino {

double normal_quantile(double p) {
    double lo = -6, hi = 6;
    for (int i = 0; i < 60; ++i) {
        const double middle = (lo + hi) / 2;
        (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? lo : hi) = middle;
    }
    return (lo + hi) / 2;
}

}  // namespace kino
