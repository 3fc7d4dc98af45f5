#pragma once

#include <cstddef>

namespace kino {

/// Learns a line y = slope * x + offset from pairs that come one after the other: recursive least
/// squares with forgetting (Ljung, System Identification, 1999, ch. 11). For frame times: x is the
/// share of pixels that are shaded, slope the time that all of them take, offset the rest.
class CostModel {
  public:
    /// `forgetting` in (0, 1]: what a pair counts one pair later.
    CostModel(double slope, double offset, double forgetting = 0.95);

    /// Pairs that are not finite are ignored. While x has not moved, only the offset follows: a
    /// line through one point could have any slope.
    void add(double x, double y);

    [[nodiscard]] double slope() const { return slope_; }
    [[nodiscard]] double offset() const { return offset_; }
    [[nodiscard]] double at(double x) const { return slope_ * x + offset_; }

  private:
    double slope_;
    double offset_;
    double forgetting_;
    double weight_ = 0;  ///< sums over the pairs, each with what it still counts
    double x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

}  // namespace kino
