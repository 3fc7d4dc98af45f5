#include "apps/window/window_replay.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/exit_codes.h"
#include "apps/viewer/budget_log.h"
#include "apps/viewer/settings.h"
#include "apps/window/viewer.h"
#include "viz/output/ui/ui_context.h"
#include "viz/output/ui/ui_renderer.h"
#include "viz/output/window.h"

namespace kino {
namespace {

void complain(const Error& error) {
    fmt::print(stderr, "kinoscope: {}\n", error.to_string());
}

/// What was asked for now goes before what is remembered.
Settings wanted_settings(const Settings& remembered, const ReplayOptions& options) {
    Settings settings = remembered;
    settings.style = options.style.value_or(settings.style);
    settings.splat_px = options.splat_px.value_or(settings.splat_px);
    settings.view = options.view.value_or(settings.view);
    settings.width = options.width.value_or(settings.width);
    settings.height = options.height.value_or(settings.height);
    return settings;
}

/// How the pictures kept up; 33 ms is a sensor's frame at 30 Hz.
void tell_times(const Viewer& viewer, bool json) {
    const TimeSeries& times = viewer.picture_times();
    constexpr TimeNs kSensorFrame = 33 * kNsPerMs;
    const char* format =
        json ? "{{\"pictures\": {}, \"ms_median\": {:.2f}, \"ms_p95\": {:.2f}, "
               "\"ms_p99\": {:.2f}, \"ms_max\": {:.2f}, \"share_within_33_ms\": {:.4f}, "
               "\"first_picture_ms\": {:.0f}, {}, \"levels\": {}}}\n"
             : "{} pictures; ms each: median {:.1f}, 95 % {:.1f}, 99 % {:.1f}, longest {:.1f}; "
               "share within 33 ms {:.3f}; first after {:.0f} ms\n";
    fmt::print(fmt::runtime(format), times.count(), times.median_ms(), times.p95_ms(),
               times.quantile_ms(0.99), times.quantile_ms(1), times.share_within(kSensorFrame),
               to_ms(viewer.first_picture_after()), viewer.latencies().to_json_members(),
               budget_log_json(viewer.budget().log()).dump());
    if (!json) fmt::print("{}\n", viewer.latencies().to_text());
}

int play(const ReplayOptions& options, const LoadedSettings& loaded, const Settings& wanted,
         Window& window, gpu::Device& device) {
    if (const auto attached = window.attach(device); !attached) {
        complain(attached.error());
        return kExitNoVulkan;
    }
    int code = kExitDone;
    {
        UiContext context(window.handle());
        auto ui = UiRenderer::create(device);
        if (!ui) {
            complain(ui.error());
            window.detach();
            return kExitFailed;
        }
        Viewer viewer(options, wanted, window, device, context, **ui);
        if (const auto ran = viewer.run(loaded.note); !ran) {
            complain(ran.error());
            code = kExitFailed;
        }
        tell_times(viewer, options.json);
        if (const auto saved = save_settings(settings_path(), viewer.settings()); !saved) {
            complain(saved.error());
        }
    }
    window.detach();
    return code;
}

}  // namespace

std::optional<int> replay_in_window(const ReplayOptions& options) {
    const LoadedSettings loaded = load_settings(settings_path());
    if (!loaded.note.empty()) fmt::print(stderr, "kinoscope: {}\n", loaded.note);
    const Settings wanted = wanted_settings(loaded.settings, options);
    auto window = Window::open({.width = wanted.width, .height = wanted.height});
    if (!window) {
        complain(window.error());
        return std::nullopt;
    }
    auto device = gpu::Device::create({.device = options.device,
                                       .validation = wants_validation(),
                                       .instance_extensions = (*window)->instance_extensions(),
                                       .presents = true});
    if (!device) {
        complain(device.error());
        return kExitNoVulkan;
    }
    // The window's surface belongs to the device's instance, so the window is left first.
    const int code = play(options, loaded, wanted, **window, **device);
    return code;
}

}  // namespace kino
