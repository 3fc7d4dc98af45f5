#pragma once

#include <cstddef>
#include <vector>

#include "base/image.h"
#include "sensor/filters/filter_kernel.h"

namespace kino::filters {

/// 1/z of a depth picture with a margin of "no reading" on all sides, so that windows need no
/// borders.
class InverseDepth {
  public:
    /// Margin in pixels, 1 or more.
    explicit InverseDepth(int margin) : margin_(margin) {}

    void fill(const Image<float>& z, const Functions& run);
    /// Elements from row to row.
    [[nodiscard]] std::ptrdiff_t pitch() const { return pitch_; }
    [[nodiscard]] const float* row(int y) const {
        return values_.data() + (y + margin_) * pitch_ + margin_;
    }

  private:
    int margin_;
    int width_ = 0, height_ = 0;
    std::ptrdiff_t pitch_ = 0;
    std::vector<float> values_;
};

}  // namespace kino::filters
