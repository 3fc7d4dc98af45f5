#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/sources.h"
#include "sensor/live/hotplug.h"
#include "sensor/source.h"
#include "viz/gpu/device.h"

namespace kino {
namespace {

using Json = nlohmann::ordered_json;

std::vector<DeviceEntry> present_sensors() {
    std::vector<DeviceEntry> all;
    for (const DeviceDriver& driver : device_drivers()) {
        for (DeviceEntry& entry : driver.list()) all.push_back(std::move(entry));
    }
    return all;
}

Json to_json(const DeviceEntry& entry) {
    return {{"uri", entry.uri},
            {"name", entry.name},
            {"serial", entry.serial},
            {"problem", entry.problem}};
}

void print_sensor(const char* mark, const DeviceEntry& entry) {
    fmt::print("  {}{:<36} {}{}\n", mark, entry.uri, entry.name,
               entry.serial.empty() ? "" : ", serial " + entry.serial);
    if (!entry.problem.empty()) fmt::print("      cannot be opened: {}\n", entry.problem);
}

/// Tells what comes and goes until Ctrl-C. A line, or with `json` an object a line, for each.
int watch_sensors(bool json) {
    catch_interrupts();
    constexpr TimeNs kLook = kNsPerSecond / 5;
    // What is plugged in needs a moment until it answers; and no watch tells everything.
    constexpr TimeNs kSettle = kNsPerSecond / 2;
    constexpr TimeNs kLookAnyway = 5 * kNsPerSecond;
    const auto watch = make_hotplug_watch();
    std::vector<DeviceEntry> known;
    const auto compare = [&] {
        std::vector<DeviceEntry> now = present_sensors();
        const auto same = [](const DeviceEntry& a, const DeviceEntry& b) {
            return a.uri == b.uri && a.problem == b.problem;
        };
        const auto tell = [&](const char* what, const char* mark,
                              const std::vector<DeviceEntry>& of,
                              const std::vector<DeviceEntry>& not_in) {
            for (const DeviceEntry& entry : of) {
                const bool there =
                    std::any_of(not_in.begin(), not_in.end(),
                                [&](const DeviceEntry& other) { return same(entry, other); });
                if (there) continue;
                if (json) {
                    Json line = to_json(entry);
                    line["change"] = what;
                    fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
                } else {
                    print_sensor(mark, entry);
                }
            }
        };
        tell("removed", "- ", known, now);
        tell("added", "+ ", now, known);
        std::fflush(stdout);
        known = std::move(now);
    };
    if (!json) fmt::print("sensors, as they come and go; Ctrl-C ends\n");
    compare();
    TimeNs next_look = now_ns() + kLookAnyway;
    while (!interrupted()) {
        if (!watch->wait(kLook).empty()) next_look = std::min(next_look, now_ns() + kSettle);
        if (now_ns() < next_look) continue;
        compare();
        next_look = now_ns() + kLookAnyway;
    }
    return kExitDone;
}

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
    out["sensors"] = Json::array();
    for (const DeviceEntry& entry : present_sensors()) out["sensors"].push_back(to_json(entry));
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
    fmt::print("\nSensors that are plugged in:\n");
    const std::vector<DeviceEntry> sensors = present_sensors();
    for (const DeviceEntry& entry : sensors) print_sensor("", entry);
    if (sensors.empty()) fmt::print("  none\n");
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
    auto watch = std::make_shared<bool>(false);
    app.add_flag("--watch", *watch, "tell what is plugged in and pulled out, until Ctrl-C");
    return [json, watch] {
        if (*watch) return watch_sensors(*json);
        register_sources();
        const auto devices = gpu::list_devices();
        return *json ? list_as_json(devices) : list_as_text(devices);
    };
}

}  // namespace kino
