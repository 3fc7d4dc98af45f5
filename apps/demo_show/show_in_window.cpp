#include <fmt/format.h>

#include "apps/demo_show/show_window.h"
#include "apps/exit_codes.h"
#include "apps/tell_error.h"

namespace kino {

std::optional<int> show_in_window(const ShowOptions& options, const ShowHelp& help) {
    const TimeNs began = now_ns();
    auto window =
        Window::open({.title = "Kinoscope demo", .width = options.width, .height = options.height});
    if (!window) {
        tell_error(window.error());
        return std::nullopt;
    }
    auto device = gpu::Device::create({.device = options.device,
                                       .validation = help.validation,
                                       .instance_extensions = (*window)->instance_extensions(),
                                       .presents = true});
    if (!device) {
        tell_error(device.error());
        return kExitNoVulkan;
    }
    if (const auto attached = (*window)->attach(**device); !attached) {
        tell_error(attached.error());
        return kExitNoVulkan;
    }
    int code = kExitDone;
    {
        ShowWindow show(options, help, **window, **device);
        if (const auto ran = show.run(began); !ran) {
            tell_error(ran.error());
            code = kExitFailed;
        } else {
            fmt::print("{}\n", show.report());
        }
    }
    (*window)->detach();
    return code;
}

}  // namespace kino
