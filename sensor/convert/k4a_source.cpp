#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "sensor/convert/imported_source.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/convert/k4a_mkv.h"
#include "sensor/decimal.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

constexpr std::size_t kSampleBytes = 40;

StreamKind stream_of(K4aRole role) {
    switch (role) {
        case K4aRole::depth:
            return StreamKind::depth;
        case K4aRole::color:
            return StreamKind::color;
        case K4aRole::infrared:
            return StreamKind::infrared;
        default:
            return StreamKind::motion;
    }
}

const char* pixels_name(K4aPixels pixels) {
    constexpr std::array<const char*, 6> kNames = {
        "16 bit big-endian", "MJPEG", "NV12", "YUY2", "BGRA", "samples"};
    return kNames[static_cast<std::size_t>(pixels)];
}

std::size_t picture_bytes(const K4aTrack& track) {
    const std::size_t area =
        static_cast<std::size_t>(track.width) * static_cast<std::size_t>(track.height);
    switch (track.pixels) {
        case K4aPixels::nv12:
            return area / 2 * 3;
        case K4aPixels::bgra:
            return area * 4;
        default:
            return area * 2;
    }
}

void big_endian_16(std::span<const std::uint8_t> bytes, Image<std::uint16_t>& out) {
    std::uint16_t* pixels = out.data();
    for (std::size_t i = 0; i < out.size(); ++i) {
        pixels[i] = static_cast<std::uint16_t>(bytes[2 * i] << 8 | bytes[2 * i + 1]);
    }
}

/// Each row of chroma serves two rows of pixels: nothing is lost and nothing made up.
std::vector<std::uint8_t> yuyv_of_nv12(std::span<const std::uint8_t> bytes, int width, int height) {
    const auto w = static_cast<std::size_t>(width);
    const auto h = static_cast<std::size_t>(height);
    std::vector<std::uint8_t> out(w * h * 2);
    for (std::size_t y = 0; y < h; ++y) {
        const std::uint8_t* luma = bytes.data() + y * w;
        const std::uint8_t* chroma = bytes.data() + w * h + y / 2 * w;
        std::uint8_t* row = out.data() + y * w * 2;
        for (std::size_t x = 0; x < w; ++x) {
            row[2 * x] = luma[x];
            row[2 * x + 1] = chroma[x];
        }
    }
    return out;
}

float float_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    std::uint32_t bits = 0;
    for (std::size_t i = 4; i > 0; --i) bits = bits << 8 | bytes[at + i - 1];
    return std::bit_cast<float>(bits);
}

struct TrackUnit {
    DepthUnit unit = DepthUnit::linear;
    double metres_per_unit = 0.001;
};

/// Of the custom track that we write; DEPTH itself is always in millimetres.
Result<TrackUnit> unit_of(const K4aFile& file, const K4aTrack* depth, const std::string& where) {
    TrackUnit out;
    const auto tag = file.tags.find("KINOSCOPE_DEPTH_UNIT");
    if (!depth || depth->name == "DEPTH" || tag == file.tags.end()) return out;
    if (tag->second == "kinect_disparity11") {
        out.unit = DepthUnit::kinect_disparity11;
        return out;
    }
    const auto metres = parse_number(tag->second);
    if (!metres || !(*metres >= 1e-6 && *metres <= 1)) {
        return fail("KINOSCOPE_DEPTH_UNIT makes no sense", where);
    }
    out.metres_per_unit = *metres;
    return out;
}

class K4aReader final : public ImportReader {
  public:
    K4aReader(std::unique_ptr<ByteSource> bytes, K4aFile file, TrackUnit unit, TimeNs origin,
              std::optional<Pose> accelerometer_from_depth, std::string where)
        : bytes_(std::move(bytes)),
          file_(std::move(file)),
          unit_(unit),
          origin_(origin),
          where_(std::move(where)) {
        if (accelerometer_from_depth) {
            depth_from_accelerometer_ = inverse(*accelerometer_from_depth).rotation;
        }
    }

    Result<StreamFrame> read(StreamKind kind, std::size_t index) override {
        const K4aBlock& block = file_.blocks[index];
        const K4aTrack& track = file_.tracks[block.track];
        const bool raw_picture = track.pixels != K4aPixels::mjpg && track.pixels != K4aPixels::imu;
        if (raw_picture && block.size != picture_bytes(track)) {
            return fail(fmt::format("a frame of track {} has {} bytes, not {}", track.name,
                                    block.size, picture_bytes(track)),
                        where_);
        }
        std::vector<std::uint8_t> data(static_cast<std::size_t>(block.size));
        if (!bytes_->read(block.data, data)) return fail("a frame could not be read", where_);
        FrameHeader header;
        header.device_time = file_.start_offset + block.time;
        header.host_time = header.device_time - origin_;
        header.sequence = static_cast<std::int64_t>(index);
        if (kind == StreamKind::motion) return motion(header, data);
        if (kind == StreamKind::color) return color(header, track, std::move(data));
        Image<std::uint16_t> raw(track.width, track.height);
        big_endian_16(data, raw);
        if (kind == StreamKind::depth) {
            auto frame = std::make_shared<DepthFrame>();
            frame->header = header;
            frame->unit = unit_.unit;
            frame->metres_per_unit = unit_.metres_per_unit;
            frame->raw = std::move(raw);
            return StreamFrame(std::shared_ptr<const DepthFrame>(std::move(frame)));
        }
        auto frame = std::make_shared<InfraredFrame>();
        frame->header = header;
        frame->raw = std::move(raw);
        frame->significant_bits = 16;
        return StreamFrame(std::shared_ptr<const InfraredFrame>(std::move(frame)));
    }

  private:
    static Result<StreamFrame> color(const FrameHeader& header, const K4aTrack& track,
                                     std::vector<std::uint8_t> data) {
        auto frame = std::make_shared<ColorFrame>();
        frame->header = header;
        frame->width = track.width;
        frame->height = track.height;
        frame->matrix = YuvMatrix::bt601;
        frame->range = YuvRange::limited;
        frame->pitch = track.width * 2;
        frame->format = PixelFormat::yuyv;
        if (track.pixels == K4aPixels::mjpg) {
            frame->format = PixelFormat::mjpeg;
            frame->pitch = 0;
            frame->range = YuvRange::full;
        } else if (track.pixels == K4aPixels::bgra) {
            frame->format = PixelFormat::rgba8;
            frame->pitch = track.width * 4;
            frame->range = YuvRange::full;
            for (std::size_t i = 0; i + 3 < data.size(); i += 4) {
                std::swap(data[i], data[i + 2]);
                data[i + 3] = 255;  // cameras leave it at 0 or 255; it means nothing
            }
        } else if (track.pixels == K4aPixels::nv12) {
            data = yuyv_of_nv12(data, track.width, track.height);
        }
        frame->bytes = std::move(data);
        return StreamFrame(std::shared_ptr<const ColorFrame>(std::move(frame)));
    }

    /// Laced samples: a count less one, perhaps sizes, then the samples. All are of one size, so
    /// they are what the block ends with.
    Result<StreamFrame> motion(const FrameHeader& header,
                               std::span<const std::uint8_t> data) const {
        std::size_t count = data.size() / kSampleBytes;
        if (data.size() % kSampleBytes != 0) {
            count = data.empty() ? 0 : std::size_t{data[0]} + 1;
        }
        if (count == 0 || count * kSampleBytes > data.size()) {
            return fail("a block of motion samples is damaged", where_);
        }
        const auto samples = data.last(count * kSampleBytes);
        glm::dvec3 sum(0);
        for (std::size_t i = 0; i < count; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                sum[axis] +=
                    float_at(samples, i * kSampleBytes + 8 + 4 * static_cast<std::size_t>(axis));
            }
        }
        const glm::dvec3 mean = depth_from_accelerometer_ * (sum / static_cast<double>(count));
        auto frame = std::make_shared<MotionFrame>();
        frame->header = header;
        for (int axis = 0; axis < 3; ++axis) {
            if (!std::isfinite(mean[axis])) {
                return fail("a motion sample is not a number", where_);
            }
            frame->acceleration_m_s2[static_cast<std::size_t>(axis)] = mean[axis];
        }
        return StreamFrame(std::shared_ptr<const MotionFrame>(std::move(frame)));
    }

    std::unique_ptr<ByteSource> bytes_;
    K4aFile file_;
    TrackUnit unit_;
    TimeNs origin_;
    glm::dquat depth_from_accelerometer_{1, 0, 0, 0};
    std::string where_;
};

void add_k4a_note(std::string& note, const std::string& more) {
    if (more.empty()) return;
    note += (note.empty() ? "" : "; ") + more;
}

const K4aTrack* track_of(const K4aFile& file, K4aRole role) {
    for (const K4aTrack& track : file.tracks) {
        if (track.role == role) return &track;
    }
    return nullptr;
}

/// A calibration that cannot be used is told about, not the end: the pictures are still good.
RigParameters rig_of(const K4aFile& file, PixelSize depth, std::optional<PixelSize> color,
                     const std::string& where) {
    std::string problem;
    if (file.own_rig) {
        auto rig = rig_from_json(*file.own_rig, where + ": kinoscope_rig.json");
        const bool fits = rig && rig->depth.width == depth.width &&
                          rig->depth.height == depth.height &&
                          (!color || (rig->color && rig->color->width == color->width &&
                                      rig->color->height == color->height));
        if (fits) return *std::move(rig);
        problem = rig ? "kinoscope_rig.json is of other pictures" : rig.error().to_string();
    }
    if (file.calibration) {
        auto rig = rig_from_k4a(*file.calibration, depth, color, where + ": calibration.json");
        if (rig) return *std::move(rig);
        if (problem.empty()) problem = rig.error().to_string();
    }
    RigParameters rig = typical_k4a_rig(depth, color);
    if (!problem.empty()) {
        rig.note =
            fmt::format("the calibration cannot be used ({}); typical values are assumed", problem);
    }
    return rig;
}

}  // namespace

Result<std::unique_ptr<Source>> make_k4a_source(std::unique_ptr<ByteSource> bytes,
                                                const std::string& uri) {
    KINO_ASSIGN(K4aFile file, index_k4a(*bytes, uri));
    Import import;
    for (const K4aRole role :
         {K4aRole::depth, K4aRole::color, K4aRole::infrared, K4aRole::motion}) {
        const K4aTrack* track = track_of(file, role);
        if (!track) continue;
        const auto number = static_cast<std::size_t>(track - file.tracks.data());
        ImportedStream stream;
        stream.info.id = {0, stream_of(role)};
        stream.info.width = track->width;
        stream.info.height = track->height;
        stream.info.format = pixels_name(track->pixels);
        if (track->frame_distance > 0) {
            stream.info.nominal_hz = 1e9 / static_cast<double>(track->frame_distance);
        }
        for (std::size_t i = 0; i < file.blocks.size(); ++i) {
            if (file.blocks[i].track == number) stream.frames.push_back(i);
        }
        std::stable_sort(stream.frames.begin(), stream.frames.end(),
                         [&](std::size_t a, std::size_t b) {
                             return file.blocks[a].time < file.blocks[b].time;
                         });
        for (const std::size_t frame : stream.frames) {
            stream.times.push_back(file.blocks[frame].time);
        }
        const std::size_t dropped = keep_rising(stream);
        if (dropped > 0) {
            file.findings.push_back(fmt::format("{} frames of {} with the time of another left out",
                                                dropped, track->name));
        }
        if (!stream.times.empty()) import.streams.push_back(std::move(stream));
    }
    if (import.streams.empty() || import.streams.front().info.id.kind == StreamKind::motion) {
        return fail("the recording holds no picture", uri);
    }
    const TimeNs origin = import.streams.front().times.front();
    const TimeNs device_origin = origin + file.start_offset;
    for (ImportedStream& stream : import.streams) {
        for (TimeNs& time : stream.times) time -= origin;
    }

    const K4aTrack* depth = track_of(file, K4aRole::depth);
    KINO_ASSIGN(const TrackUnit unit, unit_of(file, depth, uri));
    if (!depth) depth = track_of(file, K4aRole::infrared);
    const K4aTrack* color = track_of(file, K4aRole::color);
    const std::optional<PixelSize> color_size =
        color ? std::optional(PixelSize{color->width, color->height}) : std::nullopt;
    // Colour alone still needs a rig: that of the common depth mode.
    const PixelSize depth_size =
        depth ? PixelSize{depth->width, depth->height} : PixelSize{640, 576};
    import.rig = rig_of(file, depth_size, color_size, uri);
    if (const auto tag = file.tags.find("K4A_DEVICE_SERIAL_NUMBER"); tag != file.tags.end()) {
        if (import.rig.serial.empty()) import.rig.serial = tag->second;
    }
    import.info.uri = uri;
    import.info.name = "Azure Kinect " + std::filesystem::path(uri).filename().string();
    import.info.serial = import.rig.serial;
    import.info.note = import.rig.note;
    for (const std::string& finding : file.findings) add_k4a_note(import.info.note, finding);
    std::optional<Pose> accelerometer;
    if (file.calibration) accelerometer = k4a_accelerometer(*file.calibration);
    import.reader = std::make_unique<K4aReader>(std::move(bytes), std::move(file), unit,
                                                device_origin, accelerometer, uri);
    return make_imported_source(std::move(import));
}

SourceOpener k4a_opener() {
    return {.name = "Azure Kinect recording",
            .uri_pattern = "<file>.mkv of k4arecorder",
            .probe =
                [](const std::string& uri) {
                    const auto bytes = open_byte_source(uri);
                    return bytes && looks_like_k4a(**bytes);
                },
            .open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
                KINO_ASSIGN(auto bytes, open_byte_source(uri));
                return make_k4a_source(std::move(bytes), uri);
            },
            .list = nullptr};
}

}  // namespace kino
