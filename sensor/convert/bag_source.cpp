#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <utility>

#include "sensor/convert/bag_file.h"
#include "sensor/convert/bag_import.h"
#include "sensor/convert/bag_messages.h"
#include "sensor/convert/imported_source.h"

namespace kino {
namespace {

constexpr std::string_view kImages = "/image/data";
constexpr std::string_view kCamera = "/info/camera_info";
constexpr std::string_view kPlace = "/tf/0";
constexpr std::string_view kUnits = "/option/Depth Units/value";
constexpr std::string_view kDeviceInfo = "/info";

/// "/device_0/sensor_1/Color_0": what the topics of a stream begin with.
struct StreamTopic {
    std::string prefix;
    std::string sensor;  ///< "/device_0/sensor_1"
    std::string device;  ///< "/device_0"
    StreamKind kind = StreamKind::depth;
};

std::optional<StreamTopic> stream_topic(const std::string& topic) {
    if (!topic.starts_with("/device_") || !topic.ends_with(kImages)) return std::nullopt;
    StreamTopic out;
    out.prefix = topic.substr(0, topic.size() - kImages.size());
    const std::size_t stream_at = out.prefix.rfind('/');
    out.sensor = out.prefix.substr(0, stream_at);
    const std::size_t sensor_at = out.sensor.rfind('/');
    if (sensor_at == 0 || sensor_at == std::string::npos) return std::nullopt;
    out.device = out.sensor.substr(0, sensor_at);
    const std::string stream = out.prefix.substr(stream_at + 1);
    if (stream.starts_with("Depth_")) {
        out.kind = StreamKind::depth;
    } else if (stream.starts_with("Color_")) {
        out.kind = StreamKind::color;
    } else if (stream.starts_with("Infrared_")) {
        out.kind = StreamKind::infrared;
    } else {
        return std::nullopt;
    }
    return out;
}

bool is_wanted(const std::string& topic) {
    if (stream_topic(topic)) return true;
    const bool device_info =
        topic.ends_with(kDeviceInfo) && std::count(topic.begin(), topic.end(), '/') == 2;
    return topic.starts_with("/device_") && (device_info || topic.ends_with(kCamera) ||
                                             topic.ends_with(kPlace) || topic.ends_with(kUnits));
}

std::size_t bytes_per_pixel(const std::string& encoding) {
    static const std::map<std::string, std::size_t> kBytes = {
        {"mono16", 2}, {"16UC1", 2}, {"Z16", 2},    {"mono8", 1},      {"8UC1", 1},
        {"rgb8", 3},   {"bgr8", 3},  {"rgba8", 4},  {"bgra8", 4},      {"YUYV", 2},
        {"yuyv", 2},   {"UYVY", 2},  {"yuv422", 2}, {"yuv422_yuy2", 2}};
    const auto found = kBytes.find(encoding);
    return found == kBytes.end() ? 0 : found->second;
}

std::vector<std::uint8_t> packed_rows(const RosImage& image, std::size_t row) {
    std::vector<std::uint8_t> out(row * static_cast<std::size_t>(image.height));
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
        std::copy_n(image.data.begin() + static_cast<std::ptrdiff_t>(y * image.step), row,
                    out.begin() + static_cast<std::ptrdiff_t>(y * row));
    }
    return out;
}

Image<std::uint16_t> gray16(const RosImage& image, std::size_t bytes) {
    Image<std::uint16_t> out(image.width, image.height);
    for (int y = 0; y < image.height; ++y) {
        const std::uint8_t* row = image.data.data() + static_cast<std::size_t>(y) * image.step;
        for (int x = 0; x < image.width; ++x) {
            const std::uint8_t* pixel = row + static_cast<std::size_t>(x) * bytes;
            int value = pixel[0];
            if (bytes == 2) {
                value = image.big_endian ? pixel[0] << 8 | pixel[1] : pixel[1] << 8 | pixel[0];
            }
            out.at(x, y) = static_cast<std::uint16_t>(value);
        }
    }
    return out;
}

struct StreamSize {
    int width = 0;
    int height = 0;
};

class BagReader final : public ImportReader {
  public:
    BagReader(std::unique_ptr<BagFile> file, double metres_per_unit, std::string where)
        : file_(std::move(file)), metres_per_unit_(metres_per_unit), where_(std::move(where)) {}

    void set_origin(TimeNs origin) { origin_ = origin; }
    void set_size(StreamKind kind, StreamSize size) { sizes_[kind] = size; }

    Result<StreamFrame> read(StreamKind kind, std::size_t index) override {
        const BagMessage& message = file_->messages()[index];
        KINO_ASSIGN(const auto bytes, file_->read(message));
        const auto image = read_ros_image(bytes);
        if (!image) return fail("a picture in the bag is damaged", where_);
        const StreamSize size = sizes_[kind];
        if (image->width != size.width || image->height != size.height) {
            return fail(fmt::format("a picture has {}x{} pixels, the stream {}x{}", image->width,
                                    image->height, size.width, size.height),
                        where_);
        }
        const std::size_t pixel = bytes_per_pixel(image->encoding);
        const std::size_t row = pixel * static_cast<std::size_t>(image->width);
        if (pixel == 0 || row > image->step) {
            return fail(
                fmt::format("pictures of the encoding \"{}\" cannot be read", image->encoding),
                where_, "depth as Z16, colour as RGB8, BGR8, RGBA8, BGRA8, YUYV or UYVY");
        }
        FrameHeader header;
        header.device_time = image->stamp;
        header.host_time = message.time - origin_;
        header.sequence = image->sequence;
        if (kind == StreamKind::color) return color(header, *image, row);
        if (pixel > 2 || (kind == StreamKind::depth && pixel != 2)) {
            return fail(fmt::format("\"{}\" is no encoding of depth", image->encoding), where_);
        }
        if (kind == StreamKind::depth) {
            auto frame = std::make_shared<DepthFrame>();
            frame->header = header;
            frame->metres_per_unit = metres_per_unit_;
            frame->raw = gray16(*image, pixel);
            return StreamFrame(std::shared_ptr<const DepthFrame>(std::move(frame)));
        }
        auto frame = std::make_shared<InfraredFrame>();
        frame->header = header;
        frame->raw = gray16(*image, pixel);
        frame->significant_bits = pixel == 1 ? 8 : 16;
        return StreamFrame(std::shared_ptr<const InfraredFrame>(std::move(frame)));
    }

  private:
    Result<StreamFrame> color(const FrameHeader& header, const RosImage& image, std::size_t row) {
        static const std::map<std::string, PixelFormat> kFormats = {
            {"rgb8", PixelFormat::rgb8},        {"bgr8", PixelFormat::rgb8},
            {"rgba8", PixelFormat::rgba8},      {"bgra8", PixelFormat::rgba8},
            {"YUYV", PixelFormat::yuyv},        {"yuyv", PixelFormat::yuyv},
            {"UYVY", PixelFormat::uyvy},        {"yuv422", PixelFormat::uyvy},
            {"yuv422_yuy2", PixelFormat::yuyv}, {"mono8", PixelFormat::gray8},
            {"8UC1", PixelFormat::gray8}};
        const auto format = kFormats.find(image.encoding);
        if (format == kFormats.end()) {
            return fail(fmt::format("\"{}\" is no encoding of colour", image.encoding), where_);
        }
        auto frame = std::make_shared<ColorFrame>();
        frame->header = header;
        frame->format = format->second;
        frame->width = image.width;
        frame->height = image.height;
        frame->pitch = static_cast<int>(row);
        frame->range = YuvRange::limited;
        frame->bytes = packed_rows(image, row);
        if (image.encoding.starts_with("bgr")) {
            const std::size_t pixel = bytes_per_pixel(image.encoding);
            for (std::size_t i = 0; i + pixel <= frame->bytes.size(); i += pixel) {
                std::swap(frame->bytes[i], frame->bytes[i + 2]);
            }
        }
        return StreamFrame(std::shared_ptr<const ColorFrame>(std::move(frame)));
    }

    std::unique_ptr<BagFile> file_;
    double metres_per_unit_;
    std::string where_;
    TimeNs origin_ = 0;
    std::map<StreamKind, StreamSize> sizes_;
};

/// What the bag says about its streams beside pictures.
class BagFacts {
  public:
    explicit BagFacts(BagFile& file) : file_(file) {
        for (std::size_t i = 0; i < file.messages().size(); ++i) {
            by_connection_[file.messages()[i].connection].push_back(i);
        }
        for (const auto& [connection, topic] : file.topics()) {
            if (by_connection_.contains(connection)) topics_.emplace(topic, connection);
        }
    }

    /// Message numbers of a topic, times rising.
    std::vector<std::size_t> messages(const std::string& topic) const {
        // Two connections may write one topic.
        std::vector<std::size_t> all;
        for (auto [at, end] = topics_.equal_range(topic); at != end; ++at) {
            const auto& more = by_connection_.at(at->second);
            all.insert(all.end(), more.begin(), more.end());
        }
        std::sort(all.begin(), all.end());
        return all;
    }

    std::vector<std::string> topics() const {
        std::vector<std::string> names;
        for (const auto& [topic, connection] : topics_) {
            if (names.empty() || names.back() != topic) names.push_back(topic);
        }
        return names;
    }

    template <class Read>
    auto first(const std::string& topic, const Read& read) const
        -> decltype(read(std::span<const std::uint8_t>())) {
        for (const std::size_t message : messages(topic)) {
            const auto bytes = file_.read(file_.messages()[message]);
            if (!bytes) continue;
            if (auto value = read(*bytes)) return value;
        }
        return std::nullopt;
    }

    std::map<std::string, std::string> device_info(const std::string& device) const {
        std::map<std::string, std::string> out;
        for (const std::size_t message : messages(device + std::string(kDeviceInfo))) {
            const auto bytes = file_.read(file_.messages()[message]);
            const auto pair = bytes ? read_ros_key_value(*bytes) : std::nullopt;
            constexpr std::size_t kMost = 100;
            if (pair && out.size() < kMost) out.insert(*pair);
        }
        return out;
    }

  private:
    BagFile& file_;
    std::map<std::uint32_t, std::vector<std::size_t>> by_connection_;
    std::multimap<std::string, std::uint32_t> topics_;
};

void add_note(std::string& note, const std::string& more) {
    note += (note.empty() ? "" : "; ") + more;
}

CameraModel guessed_camera(StreamSize image) {
    return {.width = image.width,
            .height = image.height,
            .fx = 0.6 * image.width,
            .fy = 0.6 * image.width,
            .cx = (image.width - 1) / 2.0,
            .cy = (image.height - 1) / 2.0};
}

/// The camera of a stream, of the size that its pictures have.
CameraModel camera_of(const BagFacts& facts, const StreamTopic& topic, StreamSize picture,
                      std::string& note) {
    const auto stated = facts.first(topic.prefix + std::string(kCamera), read_ros_camera);
    const std::string stream = stream_name(topic.kind);
    if (!stated || stated->camera.width != picture.width ||
        stated->camera.height != picture.height || !validate(stated->camera, stream).has_value()) {
        add_note(note, "no usable camera_info of " + stream + ": its camera is guessed");
        return guessed_camera(picture);
    }
    CameraModel camera = stated->camera;
    const bool plain = stated->model == "Brown Conrady" || stated->model == "plumb_bob";
    if (camera.has_distortion() && !plain) {
        add_note(note,
                 fmt::format("the lens model \"{}\" of {} is left out", stated->model, stream));
        camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
    }
    return camera;
}

}  // namespace

Result<std::unique_ptr<Source>> make_bag_source(std::unique_ptr<ByteSource> bytes,
                                                const std::string& uri) {
    KINO_ASSIGN(auto file, BagFile::open(std::move(bytes), uri, is_wanted));
    BagFacts facts(*file);
    std::map<StreamKind, StreamTopic> chosen;
    for (const StreamKind kind : {StreamKind::depth, StreamKind::color, StreamKind::infrared}) {
        for (const std::string& topic : facts.topics()) {
            const auto stream = stream_topic(topic);
            if (!stream || stream->kind != kind || chosen.contains(kind)) continue;
            const auto depth = chosen.find(StreamKind::depth);
            if (depth != chosen.end() && depth->second.device != stream->device) continue;
            chosen.emplace(kind, *stream);
        }
    }
    if (!chosen.contains(StreamKind::depth)) {
        return fail("the bag holds no depth pictures of librealsense", uri,
                    "their topics are /device_0/sensor_0/Depth_0/image/data and the like");
    }

    Import import;
    std::string note;
    std::map<StreamKind, StreamSize> sizes;
    for (const auto& [kind, topic] : chosen) {
        const auto messages = facts.messages(topic.prefix + std::string(kImages));
        std::optional<CameraModel> camera;
        std::string encoding;
        for (const std::size_t message : messages) {
            const auto content = file->read(file->messages()[message]);
            const auto picture = content ? read_ros_image(*content) : std::nullopt;
            if (!picture) continue;
            encoding = picture->encoding;
            sizes[kind] = {picture->width, picture->height};
            camera = camera_of(facts, topic, sizes[kind], note);
            break;
        }
        if (!camera) {
            if (kind == StreamKind::depth) return fail("no depth picture is whole", uri);
            continue;
        }
        ImportedStream stream;
        stream.info.id = {0, kind};
        stream.info.width = camera->width;
        stream.info.height = camera->height;
        stream.info.format = encoding;
        for (const std::size_t message : messages) {
            stream.times.push_back(file->messages()[message].time);
            stream.frames.push_back(message);
        }
        const std::size_t dropped = keep_rising(stream);
        if (dropped > 0) {
            add_note(note, fmt::format("{} frames of {} with the time of another left out", dropped,
                                       stream_name(kind)));
        }
        if (kind == StreamKind::depth) import.rig.depth = *camera;
        if (kind == StreamKind::color) import.rig.color = *camera;
        import.streams.push_back(std::move(stream));
    }
    const StreamTopic& depth = chosen.at(StreamKind::depth);
    if (import.rig.color) {
        const auto color_place = facts.first(
            chosen.at(StreamKind::color).prefix + std::string(kPlace), read_ros_transform);
        const auto depth_place =
            facts.first(depth.prefix + std::string(kPlace), read_ros_transform);
        if (color_place) {
            import.rig.color_from_depth = *color_place * inverse(depth_place.value_or(Pose{}));
        } else {
            add_note(note, "the bag does not say where the cameras stand to each other");
        }
    }
    const auto units = facts.first(depth.sensor + std::string(kUnits), read_ros_float);
    const bool usable = units && *units >= 1e-6 && *units <= 1;
    if (!usable) add_note(note, "the depth unit is not stated: 1 mm is assumed");
    const double metres_per_unit = usable ? *units : 0.001;

    const auto device = facts.device_info(depth.device);
    const auto about = [&](const char* key) {
        const auto found = device.find(key);
        return found == device.end() ? std::string() : found->second;
    };
    for (const std::string& finding : file->findings()) add_note(note, finding);
    import.rig.min_depth_m = 0.1;
    import.rig.max_depth_m = 20;
    import.rig.serial = about("Serial Number");
    import.rig.note = note;
    KINO_TRY(validate(import.rig));
    import.info.uri = uri;
    import.info.name = about("Name").empty() ? "RealSense recording" : about("Name");
    import.info.serial = import.rig.serial;
    import.info.note = note;

    const TimeNs origin = import.streams.front().times.front();
    for (ImportedStream& stream : import.streams) {
        for (TimeNs& time : stream.times) time -= origin;
    }
    auto reader = std::make_unique<BagReader>(std::move(file), metres_per_unit, uri);
    reader->set_origin(origin);
    for (const auto& [kind, size] : sizes) reader->set_size(kind, size);
    import.reader = std::move(reader);
    return make_imported_source(std::move(import));
}

SourceOpener bag_opener() {
    return {.name = "librealsense bag",
            .uri_pattern = "<file>.bag",
            .probe =
                [](const std::string& uri) {
                    const auto bytes = open_byte_source(uri);
                    return bytes && looks_like_bag(**bytes);
                },
            .open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
                KINO_ASSIGN(auto bytes, open_byte_source(uri));
                return make_bag_source(std::move(bytes), uri);
            },
            .list = nullptr};
}

}  // namespace kino
