#include "sensor/v4l2/v4l2_address.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "sensor/v4l2/buffer_decoder.h"
#include "sensor/v4l2/video_format.h"

namespace kino {
namespace {

constexpr std::string_view kReserved = "%&?+=# ";

const char* meaning(StreamKind kind) {
    switch (kind) {
        case StreamKind::depth:
            return "depth";
        case StreamKind::infrared:
            return "infrared";
        default:
            return "color";
    }
}

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (kReserved.find(c) == std::string_view::npos && c >= ' ' && c != 0x7f)
            out += c;
        else
            out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

std::string unescaped(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned value = 0;
        if (text[i] == '%' && i + 2 < text.size() &&
            std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16).ptr ==
                text.data() + i + 3) {
            out += static_cast<char>(value);
            i += 2;
        } else {
            out += text[i];
        }
    }
    return out;
}

template <class T>
bool read_number(std::string_view text, T& out) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, out);
    return error == std::errc{} && stop == end;
}

Result<void> read_option(std::string_view key, const std::string& value, V4l2Address& out) {
    constexpr const char* kWhere = "v4l2 address";
    if (key == "node") {
        out.node = value;
        return {};
    }
    if (key == "calibration") {
        out.calibration = value;
        return {};
    }
    if (key == "as") {
        for (const StreamKind kind : {StreamKind::depth, StreamKind::color, StreamKind::infrared})
            if (value == meaning(kind) || value == stream_name(kind)) out.as = kind;
        if (!out.as)
            return fail(fmt::format("as={}", value), kWhere, "one of depth, infrared, color");
        return {};
    }
    if (key == "format") {
        const VideoFormat* const format = find_video_format(value);
        if (format == nullptr) {
            std::string names;
            for (const VideoFormat& known : video_formats())
                names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
            return fail(fmt::format("format={}", value), kWhere, "one of " + names);
        }
        out.format = format->name;
        return {};
    }
    if (key == "size") {
        const auto cross = value.find('x');
        const std::string_view text = value;
        if (cross == std::string::npos || !read_number(text.substr(0, cross), out.width) ||
            !read_number(text.substr(cross + 1), out.height) || out.width < 1 || out.height < 1 ||
            out.width > kMaxVideoSize || out.height > kMaxVideoSize)
            return fail(fmt::format("size={}", value), kWhere, "for example size=640x480");
        return {};
    }
    if (key == "fps") {
        if (!read_number(std::string_view(value), out.fps) || !(out.fps > 0) || out.fps > 10000)
            return fail(fmt::format("fps={}", value), kWhere, "for example fps=30");
        return {};
    }
    return fail(fmt::format("unknown option {}", key), kWhere,
                "node, as, format, size, fps, calibration");
}

bool names_unit(const std::string& unit, const VideoNode& node) {
    return unit == node.serial || unit == node.udev_serial || unit == node.bus_path;
}

}  // namespace

Result<V4l2Address> parse_v4l2_address(const std::string& text) {
    V4l2Address out;
    const auto question = text.find('?');
    out.unit = unescaped(std::string_view(text).substr(0, question));
    if (question == std::string::npos) return out;
    std::string_view rest = std::string_view(text).substr(question + 1);
    while (!rest.empty()) {
        const auto end = rest.find('&');
        const std::string_view option = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
        if (option.empty()) continue;
        const auto equals = option.find('=');
        const std::string value =
            equals == std::string_view::npos ? "" : unescaped(option.substr(equals + 1));
        KINO_TRY(read_option(option.substr(0, equals), value, out));
    }
    return out;
}

std::string V4l2Address::to_string() const {
    std::string options;
    const auto add = [&](const char* key, const std::string& value) {
        if (!value.empty())
            options += fmt::format("{}{}={}", options.empty() ? "?" : "&", key, escaped(value));
    };
    add("node", node);
    add("as", as ? meaning(*as) : "");
    add("format", format);
    add("size", width > 0 ? fmt::format("{}x{}", width, height) : "");
    add("fps", fps > 0 ? fmt::format("{}", fps) : "");
    add("calibration", calibration);
    return escaped(unit) + options;
}

std::vector<VideoNode> matching_nodes(const V4l2Address& address, VideoSystem& system) {
    std::vector<VideoNode> nodes = system.nodes();
    if (address.unit.starts_with('/')) {
        const std::string path = system.resolve(address.unit);
        for (VideoNode& node : nodes)
            if (node.path == path) return {std::move(node)};
        return {VideoNode{.path = path, .part = "0"}};
    }
    std::erase_if(nodes, [&](const VideoNode& node) {
        return (!address.unit.empty() && !names_unit(address.unit, node)) ||
               (!address.node.empty() && address.node != node.part);
    });
    return nodes;
}

V4l2Address lasting_address(const V4l2Address& asked, const VideoNode& node,
                            const std::vector<VideoNode>& nodes) {
    // Many webcams of one make carry one and the same serial.
    const auto twin = [&](const VideoNode& other) {
        return other.path != node.path && other.serial == node.serial && other.part == node.part;
    };
    V4l2Address out = asked;
    out.node = node.part;
    if (!node.serial.empty() && std::none_of(nodes.begin(), nodes.end(), twin))
        out.unit = node.serial;
    else if (!node.bus_path.empty())
        out.unit = node.bus_path;
    else
        out.unit = node.path;
    return out;
}

}  // namespace kino
