#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "sensor/jpeg.h"
#include "sensor/openni2/oni_depth_codec.h"
#include "sensor/openni2/oni_frames.h"
#include "sensor/openni2/oni_walk.h"
#include "sensor/openni2/openni2.h"
#include "sensor/openni2/openni_image.h"
#include "sensor/pairing.h"
#include "sensor/recording_source.h"

namespace kino {
namespace {

const OniNode* node_of(const OniRecords& records, std::uint32_t type) {
    for (const OniNode& node : records.nodes) {
        if (node.type == type && !node.frames.empty()) return &node;
    }
    return nullptr;
}

CameraModel camera_of(const OniNode& node, const CameraModel& fallback) {
    CameraModel camera;
    camera.width = node.width;
    camera.height = node.height;
    camera.cx = (node.width - 1) / 2.0;
    camera.cy = (node.height - 1) / 2.0;
    const bool stated = node.horizontal_fov > 0 && node.vertical_fov > 0;
    camera.fx = stated ? node.width / (2 * std::tan(node.horizontal_fov / 2))
                       : fallback.fx * node.width / fallback.width;
    camera.fy = stated ? node.height / (2 * std::tan(node.vertical_fov / 2)) : camera.fx;
    return camera;
}

RigParameters rig_of(const OniNode& depth, const OniNode* color) {
    RigParameters rig = default_kinect1_rig();
    rig.depth = camera_of(depth, rig.depth);
    if (color) {
        rig.color = camera_of(*color, *rig.color);
    } else {
        rig.color.reset();
    }
    rig.note = "cameras from the field of view that the ONI file states, not calibrated";
    return rig;
}

/// Indices into node.frames whose times rise strictly.
std::vector<std::size_t> rising(const OniRecords& records, const OniNode& node) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < node.frames.size(); ++i) {
        const std::uint64_t time = records.data[node.frames[i]].time_us;
        if (kept.empty() || time > records.data[node.frames[kept.back()]].time_us) {
            kept.push_back(i);
        }
    }
    return kept;
}

class OniReader final : public FrameReader {
  public:
    OniReader(std::unique_ptr<OniFrames> frames, std::vector<std::size_t> depth,
              std::vector<std::size_t> color)
        : frames_(std::move(frames)), depth_(std::move(depth)), color_(std::move(color)) {}

    Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) override {
        KINO_ASSIGN(DepthFrame frame, frames_->depth(depth_[static_cast<std::size_t>(index)]));
        frame.header = header(frame.header, index);
        return std::make_shared<const DepthFrame>(std::move(frame));
    }
    Result<std::shared_ptr<const ColorFrame>> color(std::int64_t index) override {
        KINO_ASSIGN(ColorFrame frame, frames_->color(color_[static_cast<std::size_t>(index)]));
        frame.header = header(frame.header, index);
        return std::make_shared<const ColorFrame>(std::move(frame));
    }

  private:
    /// Host time counts from the first depth frame, as everywhere in recordings.
    FrameHeader header(FrameHeader stated, std::int64_t index) const {
        stated.host_time = stated.device_time - frames_->depth_time(depth_.front());
        stated.sequence = index;
        return stated;
    }

    std::unique_ptr<OniFrames> frames_;
    std::vector<std::size_t> depth_;
    std::vector<std::size_t> color_;
};

Result<std::unique_ptr<Source>> open_oni(const std::string& uri) {
    const std::filesystem::path path(uri);
    KINO_ASSIGN(std::unique_ptr<OniFrames> frames, OniFrames::open(path));
    const OniRecords& records = frames->records();
    const OniNode* depth = node_of(records, oni::kDepthNode);
    if (!depth) return fail("the ONI file holds no depth", uri);
    const OniNode* color = frames->has_color() ? node_of(records, oni::kImageNode) : nullptr;

    const std::vector<std::size_t> depth_frames = rising(records, *depth);
    const std::vector<std::size_t> color_frames =
        color ? rising(records, *color) : std::vector<std::size_t>{};
    const auto times_of = [&](const OniNode* node, const std::vector<std::size_t>& kept) {
        std::vector<TimeNs> times;
        for (const std::size_t i : kept) {
            times.push_back(static_cast<TimeNs>(records.data[node->frames[i]].time_us) * 1000);
        }
        return times;
    };
    const std::vector<TimeNs> depth_times = times_of(depth, depth_frames);
    const std::vector<TimeNs> color_times = times_of(color, color_frames);
    const TimeNs limit = pairing_limit(color_times);

    Recording recording;
    for (const TimeNs time : depth_times) {
        RecordedFrame frame;
        frame.time = time;
        if (const auto pairing = pair_in_time(color_times, time, limit)) {
            frame.color = static_cast<std::int64_t>(pairing->index);
            frame.color_paired = pairing->paired;
        }
        recording.frames.push_back(frame);
    }
    recording.rig = rig_of(*depth, color);
    SourceInfo& info = recording.info;
    info.uri = uri;
    info.name = path.stem().string();
    if (!depth->device.empty()) info.name += " (" + depth->device + ")";
    info.note = recording.rig.note;
    const auto remark = [&](const std::string& text) { info.note += "; " + text; };
    if (!frames->remark().empty()) remark(frames->remark());
    if (depth_frames.size() < depth->frames.size()) {
        remark(fmt::format("{} depth frames whose time does not rise left out",
                           depth->frames.size() - depth_frames.size()));
    }
    const auto stream = [&](StreamKind kind, const OniNode& node, int format) {
        info.streams.push_back({{0, kind},
                                node.width,
                                node.height,
                                static_cast<double>(node.fps),
                                openni_format_name(format)});
    };
    stream(StreamKind::depth, *depth, frames->depth_format());
    if (color) stream(StreamKind::color, *color, frames->color_format());
    recording.reader = std::make_unique<OniReader>(std::move(frames), depth_frames, color_frames);
    return make_recording_source(std::move(recording));
}

bool probe_oni(const std::string& uri) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(uri, none)) return false;
    const auto input = open_oni_input(uri);
    std::array<std::uint8_t, 4> head{};
    return input && (*input)->read(0, head) && looks_like_oni(head);
}

}  // namespace

SourceOpener oni_opener() {
    return {"ONI recording", "<file>.oni", probe_oni, open_oni, nullptr};
}

}  // namespace kino
