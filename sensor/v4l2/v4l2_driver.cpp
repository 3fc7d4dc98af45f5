#include "sensor/v4l2/v4l2_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sensor/live/live_source.h"
#include "sensor/v4l2/negotiation.h"
#include "sensor/v4l2/v4l2_address.h"
#include "sensor/v4l2/v4l2_device.h"
#include "sensor/v4l2/video_device.h"

namespace kino {
namespace {

/// Why the node cannot be opened, empty if it can, none if it is no camera.
std::optional<std::string> problem_of(const VideoDevice& device,
                                      const VideoCapabilities& capabilities) {
    if (!capabilities.captures) return std::nullopt;
    const auto formats = list_pixel_formats(device, capabilities.multi_planar);
    if (!formats) return formats.error().to_string();
    if (formats->empty()) return std::nullopt;  // the metadata nodes of some drivers
    std::string names;
    for (const std::uint32_t fourcc : *formats) {
        if (find_video_format(fourcc) != nullptr) return "";
        names += (names.empty() ? "" : ", ") + fourcc_text(fourcc);
    }
    return fmt::format("no picture format that fits: it has {}", names);
}

std::vector<DeviceEntry> list_entries(const std::shared_ptr<VideoSystem>& system) {
    std::vector<DeviceEntry> entries;
    const std::vector<VideoNode> nodes = system->nodes();
    for (const VideoNode& node : nodes) {
        DeviceEntry entry;
        entry.uri = "v4l2:" + lasting_address({}, node, nodes).to_string();
        entry.name = node.name.empty() ? node.path : fmt::format("{} ({})", node.name, node.path);
        entry.serial = node.serial;
        const auto device = VideoDevice::open(system, node.path);
        if (!device) {
            entry.problem = device.error().to_string();
            entries.push_back(std::move(entry));
            continue;
        }
        const auto capabilities = query_capabilities(*device);
        if (!capabilities) {
            entry.problem = capabilities.error().to_string();
            entries.push_back(std::move(entry));
            continue;
        }
        auto problem = problem_of(*device, *capabilities);
        if (!problem) continue;
        entry.problem = std::move(*problem);
        entries.push_back(std::move(entry));
    }
    return entries;
}

Result<std::unique_ptr<LiveDevice>> open_device(const std::shared_ptr<VideoSystem>& system,
                                                const std::string& text) {
    KINO_ASSIGN(const V4l2Address address, parse_v4l2_address(text));
    const std::vector<VideoNode> nodes = matching_nodes(address, *system);
    if (nodes.empty())
        return fail(
            address.unit.empty() ? "no camera is plugged in" : "no such camera is plugged in",
            "v4l2:" + text, "`kinoscope devices` lists what is there");
    // Several nodes of a unit are no pictures at all; the complaint of the first says the most.
    std::optional<Error> first;
    for (const VideoNode& node : nodes) {
        auto device = V4l2Device::open(system, address, node);
        if (device) return std::unique_ptr<LiveDevice>(std::move(*device));
        if (!first) first = std::move(device).error();
    }
    return fail(std::move(*first));
}

}  // namespace

DeviceDriver v4l2_driver(std::shared_ptr<VideoSystem> system) {
    DeviceDriver driver;
    driver.scheme = "v4l2";
    driver.name = "Video4Linux camera";
    driver.uri_pattern =
        "v4l2:[/dev/videoN|serial|port][?as=depth|infrared|color&format=Z16&size=640x480&fps=30"
        "&node=1.0.0&calibration=FILE]";
    driver.list = [system] { return list_entries(system); };
    driver.open = [system](const std::string& address) { return open_device(system, address); };
    return driver;
}

SourceOpener v4l2_opener(std::shared_ptr<VideoSystem> system) {
    SourceOpener opener = live_opener(v4l2_driver(std::move(system)));
    opener.probe = [](const std::string& uri) {
        return uri.starts_with("v4l2:") && uri.find('+') == std::string::npos;
    };
    return opener;
}

}  // namespace kino
