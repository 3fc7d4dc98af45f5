#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "sensor/clip_depth.h"
#include "sensor/clip_video.h"
#include "sensor/description.h"
#include "sensor/file_bytes.h"
#include "sensor/openers.h"
#include "sensor/png_frames.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDescriptionBytes = std::size_t{4} << 20;

/// Depth frames decoded from a clip on demand.
class ClipReader final : public FrameReader {
  public:
    ClipReader(ClipVideo video, ClipDescription description)
        : video_(std::move(video)), depth_(std::move(description)) {}

    Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) override {
        KINO_ASSIGN(const auto picture, video_.picture(index));
        auto frame = std::make_shared<DepthFrame>();
        frame->header = {.device_time = video_.time_of(index),
                         .host_time = video_.time_of(index) - video_.time_of(0),
                         .sequence = index};
        frame->metres_per_unit = 1.0 / kClipUnitsPerMetre;
        depth_.decode(*picture, frame->raw);
        return frame;
    }

    Result<std::shared_ptr<const ColorFrame>> color(std::int64_t) override {
        return fail("a clip has no colour");
    }

  private:
    ClipVideo video_;
    ClipDepth depth_;
};

Result<std::vector<RecordedFrame>> open_clip(const fs::path& folder, const Description& said,
                                             Recording& recording) {
    KINO_ASSIGN(const fs::path path, path_inside(folder, said.clip->file));
    KINO_ASSIGN(ClipVideo video, ClipVideo::open(path));
    if (video.width() != said.rig.depth.width || video.height() != said.rig.depth.height) {
        return fail(fmt::format("the video is {}x{}, cameras/depth says {}x{}", video.width(),
                                video.height(), said.rig.depth.width, said.rig.depth.height),
                    path.string());
    }
    std::vector<RecordedFrame> frames(static_cast<std::size_t>(video.frame_count()));
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].time = video.time_of(static_cast<std::int64_t>(i));
    }
    recording.reader = std::make_unique<ClipReader>(std::move(video), *said.clip);
    return frames;
}

Result<std::vector<PngFrame>> list_frames(const fs::path& folder, const std::string& name) {
    KINO_ASSIGN(const fs::path inside, path_inside(folder, name));
    KINO_ASSIGN(const auto paths, png_files(inside));
    std::vector<PngFrame> frames;
    frames.reserve(paths.size());
    for (const fs::path& path : paths) frames.push_back({path, 0});
    return frames;
}

Result<std::vector<RecordedFrame>> open_frames(const fs::path& folder, const Description& said,
                                               Recording& recording) {
    PngFrames png;
    png.unit = said.unit;
    png.metres_per_unit = 1.0 / said.depth_per_metre;
    png.rig = said.rig;
    KINO_ASSIGN(png.depth, list_frames(folder, said.depth_dir));
    if (png.depth.empty()) {
        return fail("the folder holds no PNG files", (folder / said.depth_dir).string());
    }
    if (!said.times.empty() && said.times.size() != png.depth.size()) {
        return fail(fmt::format("times_ns names {} frames, {} holds {}", said.times.size(),
                                said.depth_dir, png.depth.size()),
                    folder.string());
    }
    if (!said.color_dir.empty()) {
        KINO_ASSIGN(png.color, list_frames(folder, said.color_dir));
    }
    std::map<fs::path, std::size_t> color_of;
    for (std::size_t i = 0; i < png.color.size(); ++i) color_of[png.color[i].path.filename()] = i;

    std::vector<RecordedFrame> frames(png.depth.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        PngFrame& depth = png.depth[i];
        depth.time =
            said.times.empty() ? from_seconds(static_cast<double>(i) / said.fps) : said.times[i];
        frames[i].time = depth.time;
        if (const auto found = color_of.find(depth.path.filename()); found != color_of.end()) {
            png.color[found->second].time = depth.time;
            frames[i].color = static_cast<std::int64_t>(found->second);
            frames[i].color_paired = true;
        }
    }
    recording.reader = make_png_reader(std::move(png));
    return frames;
}

std::string depth_format(const Description& said) {
    if (said.clip) return "video, brightness is depth";
    if (said.unit == DepthUnit::kinect_disparity11) return "png 11 bit disparity";
    return fmt::format("png 16 bit, {} per metre", said.depth_per_metre);
}

Result<std::unique_ptr<Source>> open_described_folder(const std::string& uri) {
    const fs::path folder(uri);
    const fs::path path = folder / "kinoscope.json";
    KINO_ASSIGN(const std::string text, read_file_text(path, kMaxDescriptionBytes));
    KINO_ASSIGN(const Description said, parse_description(text, path.string()));
    Recording recording;
    recording.rig = said.rig;
    if (said.clip) {
        KINO_ASSIGN(recording.frames, open_clip(folder, said, recording));
    } else {
        KINO_ASSIGN(recording.frames, open_frames(folder, said, recording));
        recording.last_frame_duration =
            said.times.empty() ? from_seconds(1.0 / said.fps) : TimeNs{0};
    }
    const std::vector<RecordedFrame>& frames = recording.frames;
    const double hz = frames.size() < 2 ? 0
                                        : static_cast<double>(frames.size() - 1) /
                                              to_seconds(frames.back().time - frames.front().time);
    SourceInfo& info = recording.info;
    info.uri = uri;
    info.name = said.name.empty() ? folder.lexically_normal().filename().string() : said.name;
    info.serial = said.rig.serial;
    info.note = said.note;
    info.licence = said.licence;
    info.seated_people = said.seated_people;
    info.streams.push_back({{0, StreamKind::depth},
                            said.rig.depth.width,
                            said.rig.depth.height,
                            hz,
                            depth_format(said)});
    if (!said.color_dir.empty()) {
        info.streams.push_back(
            {{0, StreamKind::color}, said.rig.color->width, said.rig.color->height, hz, "png rgb"});
    }
    return make_recording_source(std::move(recording));
}

}  // namespace

SourceOpener described_folder_opener() {
    return {.name = "folder with kinoscope.json",
            .uri_pattern = "FOLDER",
            .probe =
                [](const std::string& uri) {
                    std::error_code error;
                    return fs::is_regular_file(fs::path(uri) / "kinoscope.json", error);
                },
            .open = open_described_folder,
            .list = nullptr};
}

}  // namespace kino
