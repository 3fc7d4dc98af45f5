#include "sensor/png_frames.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "sensor/png_io.h"

namespace kino {
namespace {

constexpr std::size_t kKeptBytes = std::size_t{32} << 20;

Result<void> check_size(int width, int height, const CameraModel& camera,
                        const std::filesystem::path& path) {
    if (width == camera.width && height == camera.height) return {};
    return fail(fmt::format("the image is {}x{}, its calibration says {}x{}", width, height,
                            camera.width, camera.height),
                path.string());
}

class PngReader final : public FrameReader {
  public:
    explicit PngReader(PngFrames frames)
        : frames_(std::move(frames)),
          kept_depth_(frames_.depth.size()),
          kept_color_(frames_.color.size()) {}

    Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) override {
        const auto i = static_cast<std::size_t>(index);
        if (kept_depth_[i]) return kept_depth_[i];
        const PngFrame& file = frames_.depth[i];
        KINO_ASSIGN(Image<std::uint16_t> raw, read_png_gray16(file.path));
        KINO_TRY(check_size(raw.width(), raw.height(), frames_.rig.depth, file.path));
        auto frame = std::make_shared<DepthFrame>();
        frame->header = header(file, index);
        frame->raw = std::move(raw);
        frame->unit = frames_.unit;
        frame->metres_per_unit = frames_.metres_per_unit;
        if (keep(frame->raw.size() * 2)) kept_depth_[i] = frame;
        return frame;
    }

    Result<std::shared_ptr<const ColorFrame>> color(std::int64_t index) override {
        const auto i = static_cast<std::size_t>(index);
        if (kept_color_[i]) return kept_color_[i];
        const PngFrame& file = frames_.color[i];
        KINO_ASSIGN(const Image<Rgba8> pixels, read_png_rgba8(file.path));
        const RigParameters& rig = frames_.rig;
        KINO_TRY(check_size(pixels.width(), pixels.height(), rig.color ? *rig.color : rig.depth,
                            file.path));
        auto frame = std::make_shared<ColorFrame>();
        frame->header = header(file, index);
        frame->format = PixelFormat::rgba8;
        frame->width = pixels.width();
        frame->height = pixels.height();
        frame->pitch = pixels.width() * 4;
        frame->bytes.resize(pixels.size() * 4);
        std::memcpy(frame->bytes.data(), pixels.data(), frame->bytes.size());
        if (keep(frame->bytes.size())) kept_color_[i] = frame;
        return frame;
    }

  private:
    FrameHeader header(const PngFrame& file, std::int64_t index) const {
        return {.device_time = file.time,
                .host_time = file.time - frames_.depth.front().time,
                .sequence = index};
    }

    bool keep(std::size_t bytes) {
        if (kept_bytes_ + bytes > kKeptBytes) return false;
        kept_bytes_ += bytes;
        return true;
    }

    PngFrames frames_;
    std::vector<std::shared_ptr<const DepthFrame>> kept_depth_;
    std::vector<std::shared_ptr<const ColorFrame>> kept_color_;
    std::size_t kept_bytes_ = 0;
};

}  // namespace

std::unique_ptr<FrameReader> make_png_reader(PngFrames frames) {
    return std::make_unique<PngReader>(std::move(frames));
}

}  // namespace kino
