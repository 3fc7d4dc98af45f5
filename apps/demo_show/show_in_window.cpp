#include <fmt/format.h>

#include "apps/demo_show/show_window.h"
#include "apps/exit_codes.h"

namespace kino {
namespace {

void tell_trouble(const Error& error) {
    fmt::print(stderr, "kinoscope: {}\n", error.to_string());
}

}  // namespace

std::optional<int> show_in_window(const ShowOptions& options, const ShowHelp& help) {
    const TimeNs began = now_ns();
    auto window =
        Window::open({.title = "Kinoscope demo", .width = options.width, .height = options.height});
    if (!window) {
        tell_trouble(window.error());
        return std::nullopt;
    }
    auto device = gpu::Device::create({.device = options.device,
                                       .validation = help.validation,
                                       .instance_extensions = (*window)->instance_extensions(),
                                       .presents = true});
    if (!device) {
        tell_trouble(device.error());
        return kExitNoVulkan;
    }
    if (const auto attached = (*window)->attach(**device); !attached) {
        tell_trouble(attached.error());
        return kExitNoVulkan;
    }
    int code = kExitDone;
    {
        ShowWindow show(options, help, **window, **device);
        if (const auto ran = show.run(began); !ran) {
            tell_trouble(ran.error());
            code = kExitFailed;
        } else {
            fmt::print("{}\n", show.report());
        }
    }
    (*window)->detach();
    return code;
}

}  // namespace kino
