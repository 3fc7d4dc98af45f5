#include "sensor/filters/inverse_depth.h"

namespace kino::filters {

void InverseDepth::fill(const Image<float>& z, const Functions& run) {
    if (z.width() != width_ || z.height() != height_) {
        width_ = z.width();
        height_ = z.height();
        pitch_ = width_ + 2 * margin_;
        values_.assign(
            static_cast<std::size_t>(pitch_) * static_cast<std::size_t>(height_ + 2 * margin_),
            kNone);
    }
    for (int y = 0; y < height_; ++y) {
        run.invert(z.row(y), static_cast<std::size_t>(width_),
                   values_.data() + (y + margin_) * pitch_ + margin_);
    }
}

}  // namespace kino::filters
