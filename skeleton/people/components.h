#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"

namespace kino {

/// When two neighbouring readings belong to one surface: |a - b| <= base + slope min(a, b) +
/// noise min(a, b)^2, metres.
struct SurfaceStep {
    float base_m = 0.05f;
    float slope = 0;  ///< metres per metre: grows with the size of a cell
    float noise_per_m = 0;
    [[nodiscard]] bool joins(float a, float b) const {
        const float near = a < b ? a : b, gap = a < b ? b - a : a - b;
        return gap <= base_m + near * (slope + noise_per_m * near);
    }
};

/// Connected components of the readings where mask is not 0: left, right, upper and lower
/// neighbours that SurfaceStep joins, and the next but one where the cell between has no reading.
/// Union-find in two passes (Rosenfeld & Pfaltz 1966) with path halving.
class Components {
  public:
    /// `z_m` and `mask` of one size; masked cells have readings.
    void find(const Image<float>& z_m, const Image<std::uint8_t>& mask, const SurfaceStep& step);

    /// 0 outside the mask, else 1..count(), numbered in the order of their first cells by rows.
    [[nodiscard]] const Image<std::int32_t>& labels() const { return labels_; }
    [[nodiscard]] std::int32_t count() const { return count_; }

  private:
    [[nodiscard]] std::int32_t root(std::int32_t cell);
    void join(std::int32_t a, std::int32_t b);

    std::vector<std::int32_t> parent_;
    Image<std::int32_t> labels_;
    std::int32_t count_ = 0;
};

}  // namespace kino
