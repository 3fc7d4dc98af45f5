#include "sensor/v4l2/video_nodes.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>

namespace kino {
namespace fs = std::filesystem;
namespace {

std::string first_line(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    return line;
}

std::optional<int> number_of(const std::string& name) {
    constexpr std::string_view kPrefix = "video";
    if (!name.starts_with(kPrefix)) return std::nullopt;
    int number = 0;
    const char* const end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + kPrefix.size(), end, number);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return number;
}

/// A property that udev stored for the node whose device number is `major_minor` ("81:0").
std::string udev_property(const fs::path& data, const std::string& major_minor,
                          const std::string& key) {
    std::ifstream in(data / ("c" + major_minor));
    const std::string start = "E:" + key + "=";
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(start)) return line.substr(start.size());
    return {};
}

bool says_nothing(const std::string& serial) {
    return serial.find_first_not_of('0') == std::string::npos;
}

/// The nearest folder at or above `folder` that belongs to a USB device; empty if none.
fs::path usb_device_above(fs::path folder) {
    std::error_code ignored;
    while (folder.has_relative_path()) {
        if (fs::exists(folder / "idVendor", ignored)) return folder;
        folder = folder.parent_path();
    }
    return {};
}

VideoNode describe(const VideoNodePlaces& places, const std::string& file) {
    const fs::path entry = places.sys_class / file;
    VideoNode node;
    node.path = (places.dev / file).string();
    node.name = first_line(entry / "name");
    node.part = first_line(entry / "index");
    if (node.part.empty()) node.part = "0";

    std::error_code error;
    const fs::path parent = fs::canonical(entry / "device", error);
    if (!error) {
        node.bus_path = parent.filename().string();
        const fs::path usb = usb_device_above(parent);
        if (!usb.empty()) {
            node.serial = first_line(usb / "serial");
            if (says_nothing(node.serial)) node.serial.clear();
            const auto colon = node.bus_path.find(':');
            if (colon != std::string::npos)
                node.part = node.bus_path.substr(colon + 1) + "." + node.part;
        }
    }

    const std::string number = first_line(entry / "dev");
    if (!number.empty()) {
        node.udev_serial = udev_property(places.udev_data, number, "ID_SERIAL");
        const std::string path = udev_property(places.udev_data, number, "ID_PATH");
        if (!path.empty()) node.bus_path = path;
    }
    return node;
}

}  // namespace

std::vector<VideoNode> list_video_nodes(const VideoNodePlaces& places) {
    std::vector<std::pair<int, std::string>> found;
    std::error_code error;
    for (fs::directory_iterator it(places.sys_class, error), end; !error && it != end;
         it.increment(error)) {
        std::string name = it->path().filename().string();
        if (const auto number = number_of(name)) found.emplace_back(*number, std::move(name));
    }
    std::sort(found.begin(), found.end());
    std::vector<VideoNode> nodes;
    nodes.reserve(found.size());
    for (const auto& [number, name] : found) nodes.push_back(describe(places, name));
    return nodes;
}

}  // namespace kino
