#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "sensor/file_bytes.h"
#include "sensor/json_cursor.h"
#include "sensor/openers.h"
#include "sensor/pairing.h"
#include "sensor/png_frames.h"
#include "sensor/png_io.h"
#include "sensor/rig_json.h"
#include "sensor/trajectory.h"
#include "sensor/tum_list.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxListBytes = std::size_t{64} << 20;

struct TumCalibration {
    RigParameters rig;
    std::string name;
    std::string licence;
    std::string note;
    double depth_per_metre = 5000;
};

bool is_folder(const fs::path& path) {
    std::error_code error;
    return fs::is_directory(path, error);
}

bool is_file(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

/// What the benchmark recommends where nothing better is known: the pinhole camera its depth was
/// registered with.
TumCalibration default_calibration(const fs::path& first_depth) {
    PngSize size{640, 480};
    if (const auto real = read_png_size(first_depth)) size = *real;
    const double scale = size.width / 640.0;
    TumCalibration out;
    out.rig.depth = {.width = size.width,
                     .height = size.height,
                     .fx = 525 * scale,
                     .fy = 525 * scale,
                     .cx = (size.width - 1) / 2.0,
                     .cy = (size.height - 1) / 2.0};
    out.rig.color = out.rig.depth;
    out.note = "no calibration.json: the benchmark's default camera is assumed";
    return out;
}

Result<TumCalibration> read_calibration(const fs::path& path) {
    KINO_ASSIGN(const std::string text, read_file_text(path, std::size_t{1} << 20));
    KINO_ASSIGN(const auto document, parse_json(text, path.string()));
    const JsonCursor root(document, path.string());
    KINO_TRY(
        root.only({"name", "licence", "note", "serial", "depth_per_metre", "cameras",
                   "color_from_depth", "depth_is_registered_to_color", "disparity", "range_m"}));
    TumCalibration out;
    KINO_TRY(root.read("name", out.name));
    KINO_TRY(root.read("licence", out.licence));
    KINO_TRY(root.read("note", out.note));
    KINO_TRY(root.read("depth_per_metre", out.depth_per_metre));
    if (!(out.depth_per_metre >= 1) || out.depth_per_metre > 1e6) {
        return root.error("depth_per_metre must lie between 1 and 1000000");
    }
    KINO_ASSIGN(out.rig, read_rig_members(root));
    KINO_TRY(validate_rig_of(out.rig, path.string()));
    return out;
}

void add_note(std::string& note, const std::string& more) {
    note += (note.empty() ? "" : "; ") + more;
}

/// The frames of one stream: from `<stream>.txt`, else from the names in `<stream>/`. Empty where
/// there is neither.
Result<std::vector<PngFrame>> read_stream(const fs::path& folder, const std::string& stream,
                                          std::string& note) {
    const fs::path list_path = folder / (stream + ".txt");
    std::string from = stream + "/";
    ParsedList list;
    if (is_file(list_path)) {
        from = stream + ".txt";
        KINO_ASSIGN(const std::string text, read_file_text(list_path, kMaxListBytes));
        list = parse_tum_list(text);
        if (list.files.empty()) {
            return fail(
                fmt::format("no line of the form \"seconds file\" ({} others)", list.skipped),
                list_path.string());
        }
    } else if (is_folder(folder / stream)) {
        KINO_ASSIGN(const auto paths, png_files(folder / stream));
        std::vector<std::string> names;
        names.reserve(paths.size());
        for (const fs::path& path : paths) {
            names.push_back((fs::path(stream) / path.filename()).string());
        }
        list = list_from_names(names);
        if (list.files.empty() && list.skipped > 0) {
            return fail("no file is named by its time in seconds", (folder / stream).string(),
                        fmt::format("add {}.txt with lines \"seconds file\"", stream));
        }
    }
    if (list.skipped > 0) {
        add_note(note, fmt::format("{} entries of {} skipped", list.skipped, from));
    }
    std::vector<PngFrame> frames;
    frames.reserve(list.files.size());
    for (const TimedFile& file : list.files) {
        auto path = path_inside(folder, file.name);
        if (!path) return fail(path.error(), list_path.string());
        frames.push_back({*std::move(path), file.time});
    }
    return frames;
}

Result<Trajectory> read_trajectory(const fs::path& path, std::string& note) {
    if (!is_file(path)) return Trajectory{};
    KINO_ASSIGN(const std::string text, read_file_text(path, kMaxListBytes));
    ParsedTrajectory parsed = parse_tum_trajectory(text);
    if (parsed.trajectory.times.empty()) {
        return fail(fmt::format("no line of the form \"time tx ty tz qx qy qz qw\" ({} others)",
                                parsed.skipped),
                    path.string());
    }
    if (parsed.skipped > 0) {
        add_note(note, fmt::format("{} poses of groundtruth.txt skipped", parsed.skipped));
    }
    return std::move(parsed.trajectory);
}

std::vector<RecordedFrame> put_together(const PngFrames& png, const Trajectory& trajectory) {
    std::vector<TimeNs> color_times;
    color_times.reserve(png.color.size());
    for (const PngFrame& frame : png.color) color_times.push_back(frame.time);
    const TimeNs limit = pairing_limit(color_times);
    std::vector<RecordedFrame> frames;
    frames.reserve(png.depth.size());
    for (const PngFrame& depth : png.depth) {
        RecordedFrame& frame = frames.emplace_back();
        frame.time = depth.time;
        frame.world_from_depth = trajectory.at(depth.time);
        if (const auto pairing = pair_in_time(color_times, depth.time, limit)) {
            frame.color = static_cast<std::int64_t>(pairing->index);
            frame.color_paired = pairing->paired;
        }
    }
    return frames;
}

double nominal_hz(const std::vector<PngFrame>& frames) {
    if (frames.size() < 2) return 0;
    return static_cast<double>(frames.size() - 1) /
           to_seconds(frames.back().time - frames.front().time);
}

Result<std::unique_ptr<Source>> open_tum_folder(const std::string& uri) {
    const fs::path folder(uri);
    std::string found;
    PngFrames png;
    KINO_ASSIGN(png.depth, read_stream(folder, "depth", found));
    KINO_ASSIGN(png.color, read_stream(folder, "rgb", found));
    if (png.depth.empty()) return fail("the recording has no depth frames", uri);

    TumCalibration calibration;
    if (is_file(folder / "calibration.json")) {
        KINO_ASSIGN(calibration, read_calibration(folder / "calibration.json"));
    } else {
        calibration = default_calibration(png.depth.front().path);
    }
    if (png.color.empty()) {
        calibration.rig.color.reset();
    } else if (!calibration.rig.color) {
        return fail("there is colour, but the calibration names no colour camera",
                    (folder / "calibration.json").string(),
                    "add cameras/color or \"depth_is_registered_to_color\": true");
    }
    KINO_ASSIGN(const Trajectory trajectory, read_trajectory(folder / "groundtruth.txt", found));
    if (!found.empty()) add_note(calibration.note, found);

    png.metres_per_unit = 1.0 / calibration.depth_per_metre;
    png.rig = calibration.rig;
    Recording recording;
    recording.rig = calibration.rig;
    recording.rig.note = calibration.note;
    SourceInfo& info = recording.info;
    info.uri = uri;
    info.name = calibration.name.empty()
                    ? "TUM RGB-D " + fs::path(uri).lexically_normal().filename().string()
                    : calibration.name;
    info.serial = calibration.rig.serial;
    info.note = calibration.note;
    info.licence = calibration.licence;
    info.streams.push_back({{0, StreamKind::depth},
                            png.rig.depth.width,
                            png.rig.depth.height,
                            nominal_hz(png.depth),
                            fmt::format("png 16 bit, {} per metre", calibration.depth_per_metre)});
    if (png.rig.color) {
        info.streams.push_back({{0, StreamKind::color},
                                png.rig.color->width,
                                png.rig.color->height,
                                nominal_hz(png.color),
                                "png rgb"});
    }
    recording.frames = put_together(png, trajectory);
    recording.reader = make_png_reader(std::move(png));
    return make_recording_source(std::move(recording));
}

}  // namespace

SourceOpener tum_folder_opener() {
    return {.name = "TUM RGB-D folder",
            .uri_pattern = "FOLDER with depth/ and rgb/",
            .probe =
                [](const std::string& uri) {
                    const fs::path folder(uri);
                    return is_folder(folder) && !is_file(folder / "kinoscope.json") &&
                           (is_file(folder / "depth.txt") || is_folder(folder / "depth"));
                },
            .open = open_tum_folder,
            .list = nullptr};
}

}  // namespace kino
