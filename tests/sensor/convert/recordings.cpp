#include "recordings.h"

#include <algorithm>
#include <cstddef>

#include "base/check.h"
#include "sensor/color_conversion.h"
#include "sensor/jpeg.h"

namespace kino::test {
namespace {

constexpr TimeNs kStart = 1'305'031'453'374'112'007;
constexpr TimeNs kStep = 33'333'331;

TimeNs time_of(int i) {
    return kStart + i * kStep;
}

std::size_t row_bytes(PixelFormat format, int width) {
    const auto w = static_cast<std::size_t>(width);
    switch (format) {
        case PixelFormat::rgba8:
            return w * 4;
        case PixelFormat::rgb8:
            return w * 3;
        case PixelFormat::uyvy:
        case PixelFormat::yuyv:
            return w * 2;
        default:
            return w;
    }
}

class ClipReader final : public FrameReader {
  public:
    explicit ClipReader(Clip clip) : clip_(std::move(clip)) {}
    Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) override {
        return clip_.depth[static_cast<std::size_t>(index)];
    }
    Result<std::shared_ptr<const ColorFrame>> color(std::int64_t index) override {
        return clip_.color[static_cast<std::size_t>(index)];
    }

  private:
    Clip clip_;
};

class OwnedBytes final : public ByteSource {
  public:
    explicit OwnedBytes(std::vector<std::uint8_t> bytes)
        : bytes_(std::move(bytes)), view_(memory_byte_source(bytes_)) {}
    std::uint64_t size() const override { return view_->size(); }
    bool read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
        return view_->read(offset, out);
    }

  private:
    std::vector<std::uint8_t> bytes_;
    std::unique_ptr<ByteSource> view_;
};

}  // namespace

Clip make_clip(const ClipStyle& style) {
    Clip clip;
    clip.rig = default_kinect1_rig(style.width, style.height);
    clip.rig.serial = "A0123";
    clip.rig.note = "made for tests";
    if (style.with_color) {
        clip.rig.color->width = style.color_width;
        clip.rig.color->height = style.color_height;
        clip.rig.color->fx = clip.rig.color->fy = style.color_width * 0.83;
        clip.rig.color->cx = style.color_width / 2.0 - 0.25;
        clip.rig.color->cy = style.color_height / 2.0 - 0.75;
        clip.rig.color->k1 = 0.01;
    } else {
        clip.rig.color.reset();
    }
    for (int i = 0; i < style.frames; ++i) {
        auto depth = std::make_shared<DepthFrame>();
        depth->header = {time_of(i), time_of(i) - kStart, i, 0};
        depth->unit = style.unit;
        depth->metres_per_unit = style.metres_per_unit;
        depth->raw = Image<std::uint16_t>(style.width, style.height);
        const bool disparity = style.unit == DepthUnit::kinect_disparity11;
        for (std::size_t p = 0; p < depth->raw.size(); ++p) {
            const auto k = static_cast<std::uint32_t>(p * 97 + static_cast<std::size_t>(i) * 31);
            depth->raw.data()[p] = static_cast<std::uint16_t>(
                disparity ? (k % 9 == 0 ? 2047 : 400 + k % 600) : (k % 9 == 0 ? 0 : k % 65535));
        }
        clip.depth.push_back(std::move(depth));
        if (style.with_color) {
            auto color = std::make_shared<ColorFrame>();
            color->header = {time_of(i) + 4'000'000, time_of(i) + 4'000'000 - kStart, i + 100, 0};
            color->format = style.color;
            color->width = style.color_width;
            color->height = style.color_height;
            const std::size_t row = row_bytes(style.color, style.color_width);
            color->pitch = static_cast<int>(row);
            color->bytes.resize(row * static_cast<std::size_t>(style.color_height));
            for (std::size_t b = 0; b < color->bytes.size(); ++b) {
                color->bytes[b] =
                    static_cast<std::uint8_t>(b * 7 + static_cast<std::size_t>(i) * 13);
                if (style.color == PixelFormat::rgba8 && b % 4 == 3) color->bytes[b] = 255;
            }
            clip.color.push_back(std::move(color));
        }
        if (style.with_infrared) {
            auto infrared = std::make_shared<InfraredFrame>();
            infrared->header = {time_of(i), time_of(i) - kStart, i, 0};
            infrared->raw = Image<std::uint16_t>(style.width, style.height);
            for (std::size_t p = 0; p < infrared->raw.size(); ++p) {
                infrared->raw.data()[p] =
                    static_cast<std::uint16_t>(p * 5 + static_cast<std::size_t>(i));
            }
            clip.infrared.push_back(std::move(infrared));
        }
        if (style.with_poses) {
            const double turn = 0.1 * i;
            clip.poses.push_back({glm::dquat(std::cos(turn), 0, std::sin(turn), 0),
                                  glm::dvec3(0.1 * i, 1.5, -0.25 * i)});
        }
    }
    return clip;
}

std::unique_ptr<Source> source_of(const Clip& clip) {
    Recording recording;
    recording.info.name = "clip";
    recording.info.licence = "none";
    recording.rig = clip.rig;
    recording.info.streams.push_back(
        {{0, StreamKind::depth}, clip.rig.depth.width, clip.rig.depth.height, 30, "test"});
    if (!clip.color.empty()) {
        recording.info.streams.push_back(
            {{0, StreamKind::color}, clip.rig.color->width, clip.rig.color->height, 30, "test"});
    }
    for (std::size_t i = 0; i < clip.depth.size(); ++i) {
        RecordedFrame frame;
        frame.time = clip.depth[i]->header.device_time;
        if (!clip.color.empty()) frame.color = static_cast<std::int64_t>(i);
        frame.color_paired = !clip.color.empty();
        if (!clip.poses.empty()) frame.world_from_depth = clip.poses[i];
        recording.frames.push_back(frame);
    }
    recording.reader = std::make_unique<ClipReader>(clip);
    auto source = make_recording_source(std::move(recording));
    KINO_CHECK(subscribe_all(*source).has_value());
    return source;
}

TestGeometry::TestGeometry(const RigParameters& rig) : rig_(*Rig::create(rig)) {}

Result<void> TestGeometry::metres(const DepthFrame& frame, Image<float>& out) {
    KINO_TRY(rig_.register_depth(frame, registered_));
    out = registered_.depth_m;
    return {};
}

Result<void> TestGeometry::points(const FrameSet& set, std::vector<CloudPoint>& out) {
    KINO_TRY(rig_.register_depth(*set.depth, registered_));
    out.clear();
    for (std::size_t i = 0; i < registered_.depth_m.size(); ++i) {
        const float z = registered_.depth_m.data()[i];
        const RayXy ray = rig_.depth_rays().data()[i];
        if (z > 0) out.push_back({ray.x * z, ray.y * z, z, {1, 2, 3, 255}});
    }
    return {};
}

std::vector<FrameSet> read_all(Source& source) {
    KINO_CHECK(subscribe_all(source).has_value());
    std::vector<FrameSet> sets;
    for (;;) {
        auto set = source.next(0);
        KINO_CHECK(set.has_value());
        if (!*set) return sets;
        sets.push_back(**set);
    }
}

bool same_pixels(const DepthFrame& a, const DepthFrame& b) {
    return a.raw == b.raw && a.unit == b.unit &&
           (a.unit != DepthUnit::linear || a.metres_per_unit == b.metres_per_unit);
}

bool same_picture(const ColorFrame& a, const ColorFrame& b) {
    Image<Rgba8> left;
    Image<Rgba8> right;
    return to_rgba8(a, left).has_value() && to_rgba8(b, right).has_value() && left == right;
}

std::unique_ptr<ByteSource> owned_bytes(std::vector<std::uint8_t> bytes) {
    return std::make_unique<OwnedBytes>(std::move(bytes));
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace kino::test
