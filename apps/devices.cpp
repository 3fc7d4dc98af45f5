#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/sources.h"
#include "sensor/source.h"
#include "viz/gpu/device.h"

namespace kino {
namespace {

using Json = nlohmann::ordered_json;

int list_as_json(const Result<std::vector<gpu::DeviceInfo>>& devices) {
    Json out = {{"vulkan", Json::array()}, {"sources", Json::array()}};
    if (devices) {
        for (const gpu::DeviceInfo& device : *devices) {
            out["vulkan"].push_back({{"name", device.name},
                                     {"driver", device.driver},
                                     {"is_cpu", device.is_cpu},
                                     {"int64_atomics", device.has_int64_atomics},
                                     {"geometry_shader", device.has_geometry_shader}});
        }
    } else {
        out["vulkan_error"] = devices.error().to_string();
    }
    for (const SourceOpener& opener : source_openers()) {
        out["sources"].push_back(
            {{"name", opener.name},
             {"uri_pattern", opener.uri_pattern},
             {"available", opener.list ? Json(opener.list()) : Json::array()}});
    }
    fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
    return devices ? kExitDone : kExitNoVulkan;
}

int list_as_text(const Result<std::vector<gpu::DeviceInfo>>& devices) {
    fmt::print("Vulkan devices, best first:\n");
    if (!devices) {
        fmt::print("  none: {}\n", devices.error().to_string());
    } else {
        for (const gpu::DeviceInfo& device : *devices) {
            fmt::print("  {} [{}]{}{}{}\n", device.name, device.driver,
                       device.is_cpu ? ", draws on the processor" : "",
                       device.has_int64_atomics ? "" : ", without 64-bit atomics (compute32)",
                       device.has_geometry_shader ? "" : ", without geometry shaders");
        }
        if (devices->empty()) fmt::print("  none\n");
    }
    fmt::print("\nWhat can be opened:\n");
    for (const SourceOpener& opener : source_openers()) {
        fmt::print("  {:<28} {}\n", opener.uri_pattern, opener.name);
        if (!opener.list) continue;
        for (const std::string& uri : opener.list()) fmt::print("      {}\n", uri);
    }
    return devices ? kExitDone : kExitNoVulkan;
}

}  // namespace

Command add_devices(CLI::App& parent) {
    auto json = std::make_shared<bool>(false);
    CLI::App& app =
        *parent.add_subcommand("devices", "lists Vulkan devices and what can be opened");
    app.add_flag("--json", *json, "as JSON");
    return [json] {
        register_sources();
        const auto devices = gpu::list_devices();
        return *json ? list_as_json(devices) : list_as_text(devices);
    };
}

}  // namespace kino
