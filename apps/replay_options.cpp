#include "apps/replay_options.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

namespace kino {

const char* raster_name(RasterPath path) {
    switch (path) {
        case RasterPath::compute:
            return "compute";
        case RasterPath::compute_32bit:
            return "compute32";
        case RasterPath::hardware:
            return "hardware";
    }
    return "unknown";
}

const char* style_name(DepthStyle style) {
    return style == DepthStyle::mesh ? "mesh" : "cloud";
}

const char* color_name(ColorMode mode) {
    switch (mode) {
        case ColorMode::captured:
            return "captured";
        case ColorMode::mixed:
            return "mixed";
        case ColorMode::relit:
            return "relit";
    }
    return "unknown";
}

const char* loop_name(LoopMode mode) {
    switch (mode) {
        case LoopMode::once:
            return "once";
        case LoopMode::loop:
            return "loop";
        case LoopMode::ping_pong:
            return "ping-pong";
    }
    return "unknown";
}

const char* sync_name(PresentMode mode) {
    switch (mode) {
        case PresentMode::fifo:
            return "fifo";
        case PresentMode::mailbox:
            return "mailbox";
        case PresentMode::immediate:
            return "immediate";
    }
    return "unknown";
}

std::string ReplayOptions::contradiction() const {
    if (lod_auto && (lod || !lod_log.empty())) {
        return "--zoom auto and --lod: who chooses the zoom chooses the light, too";
    }
    if (zoom_by == SceneZoomBy::fixed) return {};
    const std::string word = fmt::format("--zoom {}", zoom_by_name(zoom_by));
    if (lod_auto) return word + " and --lod auto: only one of them can choose";
    if (!lod_log.empty()) return word + " and --lod FILE: the file says how coarse pictures are";
    return {};
}

PictureQuality ReplayOptions::quality(const SceneFile* stage) const {
    const SceneQuality wanted = stage != nullptr ? stage->quality : SceneQuality{};
    const bool asks_lod = lod.has_value() || lod_auto || !lod_log.empty();
    const bool chooses_zoom = zoom_by != SceneZoomBy::fixed;

    PictureQuality quality{.samples = samples.value_or(wanted.samples)};
    FrameBudgetOptions& budget = quality.budget;
    budget.target_ms = target_ms.value_or(wanted.target_ms);
    budget.fix_share = fix_share.value_or(wanted.fix);
    const bool scenes_budget = !asks_lod && !chooses_zoom && wanted.lod_by == SceneLodBy::budget;
    if (lod_auto || scenes_budget) {
        budget.mode = GovernorMode::automatic;
        if (zoom) {
            budget.most_zoom = *zoom;
        } else if (scenes_budget && wanted.zoom > 1) {
            budget.most_zoom = wanted.zoom;
        }
        return quality;
    }
    budget.lod = asks_lod ? lod.value_or(1) : wanted.lod;
    budget.zoom = zoom.value_or(chooses_zoom ? 1 : wanted.zoom);

    quality.zoom.target_ms = budget.target_ms;
    quality.zoom.most = most_zoom.value_or(wanted.most_zoom);
    if (chooses_zoom) {
        quality.zoom.by = zoom_by;
    } else if (!zoom && lod_log.empty()) {
        quality.zoom.by = wanted.zoom_by;
        const bool window = stage != nullptr && stage->camera.window;
        if (wanted.zoom_by == SceneZoomBy::fixed && wanted.zoom == 1 && window &&
            stage->camera.window->most_zoom > 1) {
            quality.zoom.by = SceneZoomBy::head;
            quality.zoom.most = most_zoom.value_or(stage->camera.window->most_zoom);
        }
    }
    const bool chosen = quality.zoom.by != SceneZoomBy::fixed;
    if (chosen) budget.zoom = 1;
    if (budget.lod > 1 || budget.zoom > 1 || chosen) budget.mode = GovernorMode::fixed;
    return quality;
}

bool wants_validation() {
    const char* wanted = std::getenv("KINO_VALIDATION");
    if (wanted != nullptr) return std::string_view(wanted) == "1";
#ifdef NDEBUG
    return false;
#else
    return true;
#endif
}

}  // namespace kino
