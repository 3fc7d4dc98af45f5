#include <fmt/format.h>

#include <string_view>

#include "skeleton/synthetic/performance.h"
#include "skeleton/synthetic/synthetic_source.h"

namespace kino {
namespace {

constexpr std::string_view kScheme = "synthetic:";

std::string motion_names() {
    std::string names;
    for (const Motion motion : all_motions()) {
        names += fmt::format("{}{}", names.empty() ? "" : ", ", motion_name(motion));
    }
    return names;
}

Result<void> apply_option(std::string_view option, const std::string& uri, SyntheticOptions& out) {
    const std::size_t equals = option.find('=');
    const std::string_view key = option.substr(0, equals);
    const std::string_view value =
        equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
    if (key == "noise") {
        if (value != "on" && value != "off") {
            return fail(fmt::format("noise=\"{}\" is not a choice", value), uri, "noise=on|off");
        }
        out.noise = value == "on";
        return {};
    }
    if (key == "size") {
        if (value == "640x480") {
            out.width = 640;
            out.height = 480;
        } else if (value == "320x240") {
            out.width = 320;
            out.height = 240;
        } else {
            return fail(fmt::format("size=\"{}\" is not a choice", value), uri,
                        "size=640x480|320x240");
        }
        return {};
    }
    return fail(fmt::format("unknown option \"{}\"", key), uri, "options: size, noise");
}

}  // namespace

Result<SyntheticOptions> parse_synthetic_uri(const std::string& uri) {
    std::string_view rest = uri;
    if (!rest.starts_with(kScheme)) return fail("not a synthetic: address", uri);
    rest.remove_prefix(kScheme.size());
    SyntheticOptions options;
    const std::size_t question = rest.find('?');
    const std::string_view name = rest.substr(0, question);
    options.performance = name == kPerformanceName;
    if (!name.empty() && !options.performance) {
        const auto motion = motion_from_name(name);
        if (!motion) {
            return fail(fmt::format("there is no synthetic scene \"{}\"", name), uri,
                        fmt::format("scenes: {}, {}", motion_names(), kPerformanceName));
        }
        options.motion = *motion;
    }
    if (question == std::string_view::npos) return options;
    rest.remove_prefix(question + 1);
    while (!rest.empty()) {
        const std::size_t end = rest.find('&');
        KINO_TRY(apply_option(rest.substr(0, end), uri, options));
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    }
    return options;
}

void register_synthetic_source() {
    register_source({.name = "computed person in a room",
                     .uri_pattern = "synthetic:[scene][?size=320x240][&noise=off]",
                     .probe = [](const std::string& uri) { return uri.starts_with(kScheme); },
                     .open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
                         KINO_ASSIGN(const SyntheticOptions options, parse_synthetic_uri(uri));
                         DepthSensorOptions sensor;
                         sensor.noise = options.noise;
                         KINO_ASSIGN(
                             auto source,
                             SyntheticSource::create(
                                 options.performance
                                     ? make_performance(options.width, options.height)
                                     : make_scene(options.motion, options.width, options.height),
                                 sensor, uri));
                         return std::unique_ptr<Source>(std::move(source));
                     },
                     .list =
                         [] {
                             std::vector<std::string> uris;
                             for (const Motion motion : all_motions()) {
                                 uris.push_back(fmt::format("{}{}", kScheme, motion_name(motion)));
                             }
                             uris.push_back(fmt::format("{}{}", kScheme, kPerformanceName));
                             return uris;
                         }});
}

}  // namespace kino
