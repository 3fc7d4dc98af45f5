#include "apps/window/panes.h"

#include <utility>

namespace kino {
namespace {

constexpr int kLegendHeight = 10;

int height_of(int width, int height) {
    return Panes::kWidth * height / width;
}

}  // namespace

void Panes::reset() {
    for (Pane* pane : {&depth_, &color_, &infrared_}) *pane = Pane();
    range_known_ = false;
}

Result<void> Panes::fit(Pane& pane, int width, int height) {
    if (pane.picture && pane.picture->width() == width && pane.picture->height() == height) {
        return {};
    }
    KINO_ASSIGN(pane.picture, ui_.make_picture(width, height));
    pane.pixels.resize(width, height);
    return {};
}

Result<void> Panes::show_depth(const Image<float>& depth) {
    if (const auto seen = depth_range(depth)) {
        // The range follows slowly: colours that jump from frame to frame cannot be read.
        const float part = range_known_ ? 0.05f : 1.0f;
        range_.near_m += part * (seen->near_m - range_.near_m);
        range_.far_m += part * (seen->far_m - range_.far_m);
        range_known_ = true;
    }
    KINO_TRY(fit(depth_, kWidth, height_of(depth.width(), depth.height())));
    color_depth(depth, range_, depth_.pixels);
    depth_.picture->set(std::as_const(depth_.pixels).view());
    if (!legend_.picture) {
        KINO_TRY(fit(legend_, kWidth, kLegendHeight));
        for (int y = 0; y < kLegendHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const float at = static_cast<float>(x) / (kWidth - 1);
                legend_.pixels.at(x, y) = depth_color(1 + at, {1, 2});
            }
        }
        legend_.picture->set(std::as_const(legend_.pixels).view());
    }
    return {};
}

Result<void> Panes::show(const ProcessedFrame& frame) {
    if (frame.surface) KINO_TRY(show_depth(frame.surface->depth_m));
    if (frame.color) {
        const Image<Rgba8>& color = *frame.color;
        KINO_TRY(fit(color_, kWidth, height_of(color.width(), color.height())));
        reduce_picture(color, color_.pixels);
        color_.picture->set(std::as_const(color_.pixels).view());
    }
    if (frame.set.infrared) {
        const InfraredFrame& infrared = *frame.set.infrared;
        KINO_TRY(fit(infrared_, kWidth, height_of(infrared.raw.width(), infrared.raw.height())));
        reduce_infrared(infrared.raw, infrared.significant_bits, infrared_.pixels);
        infrared_.picture->set(std::as_const(infrared_.pixels).view());
    }
    return {};
}

}  // namespace kino
