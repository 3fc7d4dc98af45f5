#include "sensor/openni2/oni_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sensor/openni2/oni_depth_codec.h"
#include "sensor/openni2/oni_format.h"
#include "sensor/openni2/openni_c.h"

namespace kino {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class T>
void put(Bytes& out, T value) {
    std::array<std::uint8_t, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    for (const std::uint8_t byte : bytes) out.push_back(byte);
}

void put_text(Bytes& out, std::string_view text) {
    put(out, static_cast<std::uint32_t>(text.size() + 1));
    out.insert(out.end(), text.begin(), text.end());
    out.push_back(0);
}

Bytes record(std::uint32_t type, std::uint32_t node, std::span<const std::uint8_t> fields,
             std::uint32_t payload_bytes = 0, std::uint64_t replaces = 0) {
    Bytes out;
    put(out, oni::kRecordMagic);
    put(out, type);
    put(out, node);
    put(out, static_cast<std::uint32_t>(oni::kRecordHeadBytes + fields.size()));
    put(out, payload_bytes);
    put(out, replaces);
    out.insert(out.end(), fields.begin(), fields.end());
    return out;
}

Bytes property(std::uint32_t type, std::uint32_t node, std::string_view name,
               std::span<const std::uint8_t> value) {
    Bytes fields;
    put_text(fields, name);
    put(fields, static_cast<std::uint32_t>(value.size()));
    fields.insert(fields.end(), value.begin(), value.end());
    return record(type, node, fields);
}

Bytes number(std::uint32_t node, std::string_view name, std::uint64_t value) {
    Bytes bytes;
    put(bytes, value);
    return property(oni::kIntProperty, node, name, bytes);
}

Bytes file_head(std::uint64_t largest_time, std::uint32_t largest_node) {
    Bytes out = {'N', 'I', '1', '0', 1, 0};
    put(out, std::uint16_t{1});
    put(out, std::uint32_t{0});
    put(out, largest_time);
    put(out, largest_node);
    return out;
}

struct WrittenFrame {
    std::uint64_t time_us = 0;
    std::uint64_t position = 0;
};

struct Stream {
    std::uint32_t node = 0;
    std::uint32_t type = 0;
    std::uint32_t codec = 0;
    std::string_view name;
    int pixel_format = 0;
    std::uint32_t openni1_format = 0;
    std::uint32_t bytes_per_pixel = 0;
    CameraModel camera;
    std::uint64_t added_at = 0;
    std::uint64_t max_depth_at = 0;
    std::vector<WrittenFrame> frames;
};

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kLeastMaxDepthMm = 10000;  // what devices state

class FileOniWriter final : public OniWriter {
  public:
    FileOniWriter(int descriptor, std::string path)
        : descriptor_(descriptor), path_(std::move(path)) {
        buffer_.reserve(kBufferBytes);
    }
    ~FileOniWriter() override { (void)close(); }

    Result<void> begin(const RigParameters& rig, double frames_per_second) {
        streams_.push_back({1,
                            oni::kDepthNode,
                            oni::kCodec16zTable,
                            "Depth",
                            openni::kDepth1Mm,
                            4,
                            2,
                            rig.depth,
                            0,
                            0,
                            {}});
        if (rig.color) {
            streams_.push_back({2,
                                oni::kImageNode,
                                oni::kCodecNone,
                                "Image",
                                openni::kRgb888,
                                1,
                                3,
                                *rig.color,
                                0,
                                0,
                                {}});
        }
        const auto fps = static_cast<std::uint32_t>(std::lround(frames_per_second));
        append(file_head(kUnknown, static_cast<std::uint32_t>(streams_.size())));
        for (Stream& stream : streams_) describe(stream, fps);
        for (const Stream& stream : streams_) {
            Bytes fields;
            put(fields, std::numeric_limits<std::uint32_t>::max());
            put(fields, kUnknown);
            append(record(oni::kNodeDataBegin, stream.node, fields));
        }
        return outcome();
    }

    Result<void> write(const DepthFrame& depth, const ColorFrame* color) override {
        if (descriptor_ < 0) return fail("the file is closed", path_);
        KINO_TRY(outcome());
        KINO_TRY(check(depth));
        if (color) KINO_TRY(check(*color));
        if (!first_time_) first_time_ = depth.header.device_time;
        const std::uint64_t time = 2 + even_us(depth.header.device_time);
        Stream& stream = streams_[0];
        if (!stream.frames.empty() && time <= stream.frames.back().time_us) {
            return fail("a depth frame not later than the last one", path_);
        }
        const std::optional<Bytes> coded = encode_16z_table(depth.raw.pixels());
        if (!coded) return fail("a frame of more than 32,768 different depths", path_);
        if (coded->size() > oni::kMaxFrameBytes) return fail("a frame too large for ONI", path_);
        for (const std::uint16_t mm : depth.raw.pixels()) {
            max_depth_ = std::max<std::uint32_t>(max_depth_, mm);
        }

        const std::uint64_t color_time = color ? 1 + even_us(color->header.device_time) : 0;
        const bool has_color =
            color && (streams_[1].frames.empty() || color_time > streams_[1].frames.back().time_us);
        if (has_color && color_time < time) add_color(*color, color_time);
        add(stream, time, *coded);
        if (has_color && color_time > time) add_color(*color, color_time);
        return outcome();
    }

    Result<void> close() override {
        if (descriptor_ < 0) return outcome();
        std::uint64_t largest_time = 0;
        for (Stream& stream : streams_) {
            append(record(oni::kNodeRemoved, stream.node, {}, 0, stream.added_at));
            const std::uint64_t table_at = position_;
            append_seek_table(stream);
            overwrite(stream.added_at, added(stream, table_at));
            if (stream.max_depth_at != 0) {
                overwrite(stream.max_depth_at, number(stream.node, "xnDeviceMaxDepth", max_depth_));
            }
            if (!stream.frames.empty()) {
                largest_time = std::max(largest_time, stream.frames.back().time_us);
            }
        }
        append(record(oni::kEnd, 0, {}));
        overwrite(0, file_head(largest_time, static_cast<std::uint32_t>(streams_.size())));
        flush();
        if (::close(descriptor_) != 0 && !error_) error_ = errno;
        descriptor_ = -1;
        return outcome();
    }

  private:
    static constexpr std::size_t kBufferBytes = std::size_t{4} << 20;

    [[nodiscard]] Result<void> outcome() const {
        if (!error_) return {};
        return fail(fmt::format("cannot be written: {}", std::strerror(*error_)), path_);
    }

    /// Microseconds since the first depth frame, rounded to even; 0 for what came before.
    [[nodiscard]] std::uint64_t even_us(TimeNs time) const {
        const TimeNs since = time - *first_time_;
        return since <= 0 ? 0 : static_cast<std::uint64_t>((since + 1000) / 2000) * 2;
    }

    [[nodiscard]] Result<void> check(const DepthFrame& depth) const {
        const CameraModel& camera = streams_[0].camera;
        if (depth.raw.width() != camera.width || depth.raw.height() != camera.height) {
            return fail(
                fmt::format("a depth frame of {} x {} in a file of {} x {}", depth.raw.width(),
                            depth.raw.height(), camera.width, camera.height),
                path_);
        }
        if (depth.unit != DepthUnit::linear || depth.metres_per_unit != 0.001) {
            return fail("depth must be in millimetres for ONI", path_);
        }
        return {};
    }

    [[nodiscard]] Result<void> check(const ColorFrame& color) const {
        if (streams_.size() < 2) return fail("a colour frame in a file without colour", path_);
        const CameraModel& camera = streams_[1].camera;
        if (color.format != PixelFormat::rgb8 || color.width != camera.width ||
            color.height != camera.height || color.pitch < 3 * color.width ||
            color.bytes.size() < static_cast<std::size_t>(color.pitch) * (color.height - 1) +
                                     std::size_t{3} * color.width) {
            return fail(fmt::format("colour must be rgb8 of {} x {} for this ONI file",
                                    camera.width, camera.height),
                        path_);
        }
        return {};
    }

    [[nodiscard]] static Bytes added(const Stream& stream, std::uint64_t seek_table_at) {
        Bytes fields;
        put_text(fields, stream.name);
        put(fields, stream.type);
        put(fields, stream.codec);
        put(fields, static_cast<std::uint32_t>(stream.frames.size()));
        put(fields, std::uint64_t{0});
        put(fields, stream.frames.empty() ? 0 : stream.frames.back().time_us);
        put(fields, seek_table_at);
        return record(oni::kNodeAdded, stream.node, fields);
    }

    void describe(Stream& stream, std::uint32_t fps) {
        const std::uint32_t node = stream.node;
        const CameraModel& camera = stream.camera;
        const auto width = static_cast<std::uint32_t>(camera.width);
        const auto height = static_cast<std::uint32_t>(camera.height);
        const auto general = [&](std::string_view name, const Bytes& value) {
            append(property(oni::kGeneralProperty, node, name, value));
        };
        stream.added_at = position_;
        append(added(stream, 0));
        Bytes device(openni::kMaxText, 0);
        constexpr std::string_view kName = "Kinoscope";
        std::copy(kName.begin(), kName.end(), device.begin());
        general("oniOriginalDevice", device);
        append(number(node, "oniRequiredFrameSize", width * height * stream.bytes_per_pixel));
        append(number(node, "xnIsGenerating", 1));
        if (stream.type == oni::kDepthNode) {
            stream.max_depth_at = position_;
            append(number(node, "xnDeviceMaxDepth", kLeastMaxDepthMm));
        }
        Bytes mode;
        for (const std::uint32_t value : {width, height, fps}) put(mode, value);
        append(number(node, "xnSupportedMapOutputModesCount", 1));
        general("xnSupportedMapOutputModes", mode);
        general("xnMapOutputMode", mode);
        Bytes formats;
        put(formats, std::uint32_t{1} << (stream.openni1_format - 1));
        general("xnSupportedPixelFormats", formats);
        append(number(node, "xnPixelFormat", stream.openni1_format));
        append(number(node, "oniPixelFormat", static_cast<std::uint64_t>(stream.pixel_format)));
        Bytes view;
        put(view, 2 * std::atan(camera.width / (2 * camera.fx)));
        put(view, 2 * std::atan(camera.height / (2 * camera.fy)));
        general("xnFOV", view);
        append(number(node, "Cropping", 1));
        general("xnCropping", Bytes(12, 0));
        append(number(node, "Mirror", 1));
        append(number(node, "xnMirror", 0));
        append(record(oni::kNodeStateReady, node, {}));
    }

    void add(Stream& stream, std::uint64_t time_us, std::span<const std::uint8_t> payload) {
        Bytes fields;
        put(fields, time_us);
        put(fields, static_cast<std::uint32_t>(stream.frames.size() + 1));
        const std::uint64_t replaces = stream.frames.empty() ? 0 : stream.frames.back().position;
        stream.frames.push_back({time_us, position_});
        append(record(oni::kNewData, stream.node, fields,
                      static_cast<std::uint32_t>(payload.size()), replaces));
        append(payload);
    }

    void add_color(const ColorFrame& color, std::uint64_t time_us) {
        const std::size_t row_bytes = std::size_t{3} * color.width;
        packed_.resize(row_bytes * static_cast<std::size_t>(color.height));
        for (int y = 0; y < color.height; ++y) {
            std::memcpy(packed_.data() + row_bytes * y,
                        color.bytes.data() + static_cast<std::size_t>(color.pitch) * y, row_bytes);
        }
        add(streams_[1], time_us, packed_);
    }

    /// Entry 0, which stands for "before the first frame", names the first frame: the player goes
    /// there for the other streams, and a position that is no record stops it for good.
    void append_seek_table(const Stream& stream) {
        Bytes payload;
        payload.reserve((stream.frames.size() + 1) * oni::kSeekEntryBytes);
        const auto entry = [&](std::uint64_t time, std::uint64_t position) {
            put(payload, time);
            put(payload, std::uint32_t{0});
            put(payload, position);
        };
        entry(0, stream.frames.empty() ? 0 : stream.frames.front().position);
        for (const WrittenFrame& frame : stream.frames) entry(frame.time_us, frame.position);
        append(
            record(oni::kSeekTable, stream.node, {}, static_cast<std::uint32_t>(payload.size())));
        append(payload);
    }

    void append(std::span<const std::uint8_t> bytes) {
        buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
        position_ += bytes.size();
        if (buffer_.size() >= kBufferBytes) flush();
    }

    void flush() {
        put_at(position_ - buffer_.size(), buffer_);
        buffer_.clear();
    }

    void overwrite(std::uint64_t position, std::span<const std::uint8_t> bytes) {
        flush();
        put_at(position, bytes);
    }

    void put_at(std::uint64_t position, std::span<const std::uint8_t> bytes) {
        while (!bytes.empty() && !error_) {
            const ssize_t put =
                pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(position));
            if (put < 0 && errno == EINTR) continue;
            if (put <= 0) {
                error_ = put < 0 ? errno : ENOSPC;
                return;
            }
            bytes = bytes.subspan(static_cast<std::size_t>(put));
            position += static_cast<std::uint64_t>(put);
        }
    }

    int descriptor_;
    std::string path_;
    std::vector<Stream> streams_;
    std::optional<TimeNs> first_time_;
    std::uint32_t max_depth_ = kLeastMaxDepthMm;
    Bytes buffer_;
    Bytes packed_;
    std::uint64_t position_ = 0;  ///< end of the file once the buffer is written
    std::optional<int> error_;
};

}  // namespace

Result<std::unique_ptr<OniWriter>> OniWriter::create(const std::filesystem::path& file,
                                                     const RigParameters& rig,
                                                     double frames_per_second) {
    KINO_TRY(validate(rig));
    if (!(frames_per_second >= 1 && frames_per_second <= 1000)) {
        return fail(fmt::format("{} frames a second", frames_per_second), file.string());
    }
    const auto fits = [](const CameraModel& camera, std::uint64_t bytes_per_pixel) {
        return bytes_per_pixel * static_cast<std::uint64_t>(camera.width) *
                   static_cast<std::uint64_t>(camera.height) <=
               oni::kMaxFrameBytes;
    };
    // A coded depth frame takes at most three bytes a pixel, and its table.
    if (!fits(rig.depth, 3) || (rig.color && !fits(*rig.color, 3))) {
        return fail("frames larger than 1600 x 1200 do not fit into ONI", file.string());
    }
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        return fail(fmt::format("cannot be made: {}", std::strerror(errno)), file.string());
    }
    auto writer = std::make_unique<FileOniWriter>(descriptor, file.string());
    KINO_TRY(writer->begin(rig, frames_per_second));
    return writer;
}

}  // namespace kino
