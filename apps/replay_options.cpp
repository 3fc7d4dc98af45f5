#include "apps/replay_options.h"

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

FrameBudgetOptions ReplayOptions::budget() const {
    FrameBudgetOptions options{
        .target_ms = target_ms, .lod = lod, .zoom = zoom.value_or(1), .fix_share = fix_share};
    if (lod_auto) {
        options.mode = GovernorMode::automatic;
        options.most_zoom = zoom.value_or(options.most_zoom);
    } else if (options.lod > 1 || options.zoom > 1) {
        options.mode = GovernorMode::fixed;
    }
    return options;
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
