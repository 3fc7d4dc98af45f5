#include "viz/quality/governor/cost_model.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace kino {

/// Variance of x below which a slope means nothing (framebuffer-LOD card, step 8).
constexpr double kLeastVariance = 1e-4;

CostModel::CostModel(double slope, double offset, double forgetting)
    : slope_(slope), offset_(offset), forgetting_(forgetting) {
    KINO_CHECK(forgetting > 0 && forgetting <= 1);
}

void CostModel::add(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    weight_ = forgetting_ * weight_ + 1;
    x_ = forgetting_ * x_ + x;
    y_ = forgetting_ * y_ + y;
    xx_ = forgetting_ * xx_ + x * x;
    xy_ = forgetting_ * xy_ + x * y;
    const double mean_x = x_ / weight_;
    const double mean_y = y_ / weight_;
    const double variance = xx_ / weight_ - mean_x * mean_x;
    if (variance > kLeastVariance) {
        // More pixels never cost less: a negative slope is noise.
        slope_ = std::max(0.0, (xy_ / weight_ - mean_x * mean_y) / variance);
    }
    offset_ = mean_y - slope_ * mean_x;
}

}  // namespace kino
