#include "sensor/description.h"

#include <fmt/format.h>

#include "sensor/json_cursor.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

constexpr std::size_t kMaxFrames = 1'000'000;

Result<double> number_between(const JsonCursor& object, const char* key, double least,
                              double most) {
    KINO_ASSIGN(const JsonCursor member, object.member(key));
    KINO_ASSIGN(const double value, member.number());
    if (value < least || value > most) {
        return member.error(fmt::format("must lie between {} and {}", least, most));
    }
    return value;
}

Result<std::string> name_of(const JsonCursor& object, const char* key) {
    KINO_ASSIGN(const JsonCursor member, object.member(key));
    KINO_ASSIGN(std::string name, member.text());
    if (name.empty()) return member.error("must not be empty");
    return name;
}

Result<void> read_depth(const JsonCursor& object, Description& out) {
    KINO_TRY(object.only({"dir", "unit", "per_metre"}));
    KINO_ASSIGN(out.depth_dir, name_of(object, "dir"));
    const auto unit = object.find("unit");
    if (unit.has_value() == object.find("per_metre").has_value()) {
        return object.error("needs either \"unit\" or \"per_metre\"");
    }
    if (!unit) {
        KINO_ASSIGN(out.depth_per_metre, number_between(object, "per_metre", 1, 1e6));
        return {};
    }
    KINO_ASSIGN(const std::string name, unit->text());
    if (name == "kinect_disparity11") {
        out.unit = DepthUnit::kinect_disparity11;
    } else if (name != "millimetres") {
        return unit->error(fmt::format("unknown unit \"{}\"", name),
                           "known: millimetres, kinect_disparity11");
    }
    return {};
}

Result<void> read_times(const JsonCursor& root, Description& out) {
    const auto times = root.find("times_ns");
    if (times.has_value() == root.find("fps").has_value()) {
        return root.error("needs either \"fps\" or \"times_ns\"");
    }
    if (!times) {
        KINO_ASSIGN(out.fps, number_between(root, "fps", 0.001, 1000));
        return {};
    }
    KINO_ASSIGN(const auto items, times->items(1, kMaxFrames));
    out.times.reserve(items.size());
    for (const JsonCursor& item : items) {
        // Half the range, so that differences cannot overflow.
        KINO_ASSIGN(const TimeNs time, item.integer(0, INT64_MAX / 2));
        if (!out.times.empty() && time <= out.times.back()) {
            return item.error("times must rise from frame to frame");
        }
        out.times.push_back(time);
    }
    return {};
}

Result<ClipDescription> read_clip(const JsonCursor& object) {
    KINO_TRY(object.only({"file", "code", "scale", "bright_m", "dark_m", "invalid_below",
                          "edge_span", "smooth_span"}));
    ClipDescription clip;
    KINO_ASSIGN(clip.file, name_of(object, "file"));
    KINO_ASSIGN(const JsonCursor code, object.member("code"));
    KINO_ASSIGN(const std::string name, code.text());
    if (name == "rgb_sum") {
        clip.code = ClipCode::rgb_sum;
    } else if (name != "luma") {
        return code.error(fmt::format("unknown code \"{}\"", name), "known: luma, rgb_sum");
    }
    if (const auto scale = object.find("scale")) {
        KINO_ASSIGN(const std::string scale_name, scale->text());
        if (scale_name == "freenect_viewer") {
            clip.scale = ClipScale::freenect_viewer;
        } else if (scale_name != "linear") {
            return scale->error(fmt::format("unknown scale \"{}\"", scale_name),
                                "known: linear, freenect_viewer");
        }
    }
    if (clip.scale == ClipScale::linear) {
        KINO_ASSIGN(clip.bright_m, number_between(object, "bright_m", 0.01, 8));
        KINO_ASSIGN(clip.dark_m, number_between(object, "dark_m", 0.01, 8));
    } else {
        for (const char* key : {"bright_m", "dark_m"}) {
            if (const auto needless = object.find(key)) {
                return needless->error("the scale freenect_viewer has distances of its own",
                                       "leave it out, or say \"scale\": \"linear\"");
            }
        }
    }
    KINO_ASSIGN(clip.invalid_below, number_between(object, "invalid_below", 0, 1));
    if (object.find("edge_span")) {
        KINO_ASSIGN(clip.edge_span, number_between(object, "edge_span", 0, 1));
    }
    if (object.find("smooth_span")) {
        KINO_ASSIGN(clip.smooth_span, number_between(object, "smooth_span", 0, 1));
    }
    return clip;
}

}  // namespace

Result<Description> parse_description(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const auto document, parse_json(text, where));
    const JsonCursor root(document, where);
    KINO_TRY(root.only({"kinoscope", "name", "licence", "note", "people", "serial", "fps",
                        "times_ns", "depth", "color", "clip", "cameras", "color_from_depth",
                        "depth_is_registered_to_color", "disparity", "range_m"}));
    KINO_ASSIGN(const JsonCursor version, root.member("kinoscope"));
    KINO_TRY(version.integer(1, 1));
    Description out;
    KINO_TRY(root.read("name", out.name));
    KINO_TRY(root.read("licence", out.licence));
    KINO_TRY(root.read("note", out.note));
    if (const auto people = root.find("people")) {
        KINO_ASSIGN(const std::string how, people->text());
        out.seated_people = how == "seated";
        if (!out.seated_people && how != "standing") {
            return people->error(fmt::format("\"{}\" is no way to be", how),
                                 "known: standing, seated");
        }
    }
    KINO_ASSIGN(out.rig, read_rig_members(root));
    KINO_TRY(validate_rig_of(out.rig, where));

    if (const auto clip = root.find("clip")) {
        for (const char* key : {"depth", "color", "fps", "times_ns"}) {
            if (root.find(key)) {
                return root.error(fmt::format("a clip cannot be combined with \"{}\"", key));
            }
        }
        if (out.rig.color) return root.error("a clip has depth only, but a colour camera is named");
        KINO_ASSIGN(out.clip, read_clip(*clip));
        return out;
    }
    KINO_ASSIGN(const JsonCursor depth, root.member("depth"));
    KINO_TRY(read_depth(depth, out));
    if (const auto color = root.find("color")) {
        KINO_TRY(color->only({"dir"}));
        KINO_ASSIGN(out.color_dir, name_of(*color, "dir"));
        if (!out.rig.color) {
            return root.error("there is colour, but no colour camera",
                              "add cameras/color or \"depth_is_registered_to_color\": true");
        }
    }
    KINO_TRY(read_times(root, out));
    return out;
}

}  // namespace kino
