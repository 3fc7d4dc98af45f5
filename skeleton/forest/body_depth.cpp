#include "skeleton/forest/body_depth.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "skeleton/forest/forest.h"

namespace kino {

std::int16_t forest_scale(double focal_px, int depth_mm) {
    const double scale = focal_px / depth_mm * 32768 / kForestOffsetsPerMm;
    return static_cast<std::int16_t>(std::min(std::floor(scale + 0.5), 32767.0));
}

void BodyDepth::set(ImageView<const std::uint16_t> depth_mm, ImageView<const std::uint8_t> body,
                    std::uint8_t which, double focal_px, int step) {
    KINO_CHECK(depth_mm.width == body.width && depth_mm.height == body.height);
    KINO_CHECK(depth_mm.width <= 16384 && depth_mm.height <= 16384);
    KINO_CHECK(focal_px > 0 && step > 0);
    const auto belongs = [&](int x, int y) {
        const std::uint16_t z = depth_mm.at(x, y);
        return body.at(x, y) == which && z > 0 && z < kForestBackgroundMm;
    };
    int x0 = depth_mm.width, x1 = -1, y0 = depth_mm.height, y1 = -1;
    for (int y = 0; y < depth_mm.height; ++y) {
        int first = 0, last = depth_mm.width - 1;
        while (first <= last && !belongs(first, y)) ++first;
        if (first > last) continue;
        while (!belongs(last, y)) --last;
        x0 = std::min(x0, first);
        x1 = std::max(x1, last);
        y0 = std::min(y0, y);
        y1 = y;
    }
    xy_.clear();
    scale_.clear();
    if (x1 < 0) {
        x0 = y0 = 0;
        x1 = y1 = -1;
    }
    left_ = x0 - 1;
    top_ = y0 - 1;
    width_ = x1 - x0 + 3;
    height_ = y1 - y0 + 3;
    // The gathers read 32 bits from the last pixel.
    padded_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 2,
                   static_cast<std::uint16_t>(kForestBackgroundMm));
    const double numerator = focal_px * 32768 / kForestOffsetsPerMm;
    for (int y = y0; y <= y1; ++y) {
        std::uint16_t* row = padded_.data() + (y - top_) * width_ - left_;
        for (int x = x0; x <= x1; ++x) {
            if (!belongs(x, y)) continue;
            const std::uint16_t z = depth_mm.at(x, y);
            row[x] = z;
            if (x % step != 0 || y % step != 0) continue;
            xy_.push_back(static_cast<std::uint32_t>(x - left_) |
                          static_cast<std::uint32_t>(y - top_) << 16);
            scale_.push_back(
                static_cast<std::int16_t>(std::min(std::floor(numerator / z + 0.5), 32767.0)));
        }
    }
}

std::int32_t BodyDepth::depth_mm(int x, int y) const {
    const int px = std::clamp(x - left_, 0, width_ - 1);
    const int py = std::clamp(y - top_, 0, height_ - 1);
    return padded_.empty() ? kForestBackgroundMm
                           : padded_[static_cast<std::size_t>(py * width_ + px)];
}

forest::WalkImage BodyDepth::image() const {
    return {padded_.data(), width_, static_cast<std::int16_t>(width_ - 1),
            static_cast<std::int16_t>(height_ - 1)};
}

forest::WalkPixels BodyDepth::pixels() const {
    return {xy_.data(), scale_.data(), xy_.size()};
}

}  // namespace kino
