#include "apps/pipeline/processor.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "calibration/color_in_depth.h"
#include "sensor/color_conversion.h"
#include "sensor/filters/linear_depth.h"

namespace kino {
namespace {

/// Versions differ between processors too: the renderer may be shown one after the other.
std::uint64_t next_version() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
}

void dim(Image<Rgba8>& image) {
    const auto half = [](std::uint8_t v) {
        return static_cast<std::uint8_t>(std::lround(v * kUnpairedBrightness));
    };
    for (Rgba8& pixel : image.pixels()) {
        pixel = {half(pixel.r), half(pixel.g), half(pixel.b), pixel.a};
    }
}

}  // namespace

Result<Processor> Processor::create(const RigParameters& parameters, const RigOptions& options,
                                    DepthFilterChain filters,
                                    const std::optional<DepthBias>& bias) {
    RigParameters seen = parameters;
    seen.depth = filters.camera(parameters.depth);
    KINO_ASSIGN(Rig rig, Rig::create(seen, options));
    Processor processor(std::move(rig));
    if (bias) processor.bias_.emplace(*bias, parameters.depth.width, parameters.depth.height);
    if (!filters.empty() || bias) {
        RigParameters depth_only = parameters;
        depth_only.color.reset();
        KINO_ASSIGN(processor.metres_, Rig::create(std::move(depth_only), options));
        processor.filters_ = std::move(filters);
    }
    return processor;
}

Processor::Processor(Rig rig)
    : rig_(std::move(rig)), rays_(std::make_shared<Image<RayXy>>(rig_.depth_rays())) {}

Result<void> Processor::take_color(const FrameSet& set) {
    if (!set.color) return {};
    std::shared_ptr<Image<Rgba8>> color = colors_.take();
    KINO_TRY(to_rgba8(*set.color, *color));
    const auto& camera = rig_.parameters().color;
    if (camera && (color->width() != camera->width || color->height() != camera->height)) {
        return fail(fmt::format("the colour picture is {}x{}, its calibration says {}x{}",
                                color->width(), color->height(), camera->width, camera->height));
    }
    last_color_ = std::move(color);
    return {};
}

Result<const DepthFrame*> Processor::filtered(const FrameSet& set) {
    if (filters_.empty() && !bias_) return set.depth.get();
    KINO_TRY(metres_->register_depth(*set.depth, unfiltered_));
    if (bias_) bias_->correct(unfiltered_.depth_m);
    if (!filters_.empty()) filters_.apply(unfiltered_.depth_m, filtered_m_);
    linear_depth(filters_.empty() ? unfiltered_.depth_m : filtered_m_, filtered_);
    return &filtered_;
}

Result<void> Processor::make_surface(const FrameSet& set, ProcessedFrame& out) {
    const TimeNs began = now_ns();
    KINO_ASSIGN(const DepthFrame* const depth, filtered(set));
    const TimeNs filtered = now_ns();
    std::shared_ptr<DepthSurface> surface = surfaces_.take();
    // The rig writes into the surface's own memory; the images change places instead of a copy.
    std::swap(registered_.depth_m, surface->depth_m);
    Result<void> done = rig_.register_depth(*depth, registered_);
    std::swap(registered_.depth_m, surface->depth_m);
    KINO_TRY(std::move(done));
    if (last_color_ && rig_.parameters().color) {
        register_color(registered_.uv, *last_color_, ColorSampling::bilinear, surface->color);
        if (!set.color || !set.color_paired) dim(surface->color);
    } else {
        surface->color.resize(0, 0);
    }
    surface->rays = rays_;
    surface->focal_px = rig_.parameters().depth.fx;
    surface->version = out.version;
    out.times.filter = filtered - began;
    out.times.registration = now_ns() - filtered;
    out.valid_points =
        std::count_if(surface->depth_m.pixels().begin(), surface->depth_m.pixels().end(),
                      [](float z) { return z > 0; });
    out.surface = std::move(surface);
    return {};
}

Result<ProcessedFrame> Processor::process(FrameSet set) {
    if (!set.depth && !set.color && !set.infrared) {
        return fail(fmt::format("frame {} has no picture", set.index));
    }
    ProcessedFrame out;
    out.arrived = now_ns();
    out.version = next_version();
    KINO_TRY(take_color(set));
    out.times.color = now_ns() - out.arrived;
    if (set.depth) KINO_TRY(make_surface(set, out));
    out.color = last_color_;
    out.set = std::move(set);
    out.ready = now_ns();
    return out;
}

}  // namespace kino
