#include "apps/window/window_replay.h"

#include <fmt/format.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>
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
#include "viz/quality/zoom/zoom_choice.h"

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

/// Retraces of the screen a second; 60 where it does not say.
double refresh_hz() {
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
    return mode != nullptr && mode->refreshRate > 0 ? mode->refreshRate : 60;
}

/// How the pictures kept up; 33 ms is a sensor's frame at 30 Hz. `interval` is from hand-over to
/// hand-over; the window paces itself, so the model of the display stands for one that does not.
nlohmann::ordered_json times_json(const Viewer& viewer, PresentMode mode, double hz) {
    const TimeSeries& times = viewer.picture_times();
    const FrameSync sync = mode == PresentMode::fifo ? FrameSync::fifo : FrameSync::free_running;
    nlohmann::ordered_json json = {
        {"pictures", times.count()},
        {"ms_median", times.median_ms()},
        {"ms_p95", times.p95_ms()},
        {"ms_p99", times.quantile_ms(0.99)},
        {"ms_max", times.quantile_ms(1)},
        {"share_within_33_ms", times.share_within(33 * kNsPerMs)},
        {"first_picture_ms", std::round(to_ms(viewer.first_picture_after()))}};
    json.update(nlohmann::ordered_json::parse("{" + viewer.latencies().to_json_members() + "}"));
    json["sync"] = {{"mode", sync_name(mode)},
                    {"refresh_hz", hz},
                    {"interval_ms_median", viewer.intervals().median_ms()},
                    {"waited_ms_median", viewer.waits().median_ms()},
                    {"model_interval_ms", frame_interval_ms(times.median_ms(), hz, sync)}};
    json["zoom_by"] = zoom_by_name(viewer.chooser().options().by);
    json["levels"] = budget_log_json(viewer.budget().log());
    return json;
}

void tell_times(const Viewer& viewer, PresentMode mode, bool json) {
    const double hz = refresh_hz();
    if (json) return fmt::print("{}\n", times_json(viewer, mode, hz).dump());
    const TimeSeries& times = viewer.picture_times();
    fmt::print(
        "{} pictures; ms each: median {:.1f}, 95 % {:.1f}, 99 % {:.1f}, longest {:.1f}; "
        "share within 33 ms {:.3f}; first after {:.0f} ms\n",
        times.count(), times.median_ms(), times.p95_ms(), times.quantile_ms(0.99),
        times.quantile_ms(1), times.share_within(33 * kNsPerMs),
        to_ms(viewer.first_picture_after()));
    fmt::print("shown by {} at {:.0f} Hz every {:.1f} ms, {:.1f} ms of it waiting\n",
               sync_name(mode), hz, viewer.intervals().median_ms(), viewer.waits().median_ms());
    fmt::print("{}\n", viewer.latencies().to_text());
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
        tell_times(viewer, window.present_mode(), options.json);
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
    auto window =
        Window::open({.width = wanted.width, .height = wanted.height, .present = options.sync});
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
