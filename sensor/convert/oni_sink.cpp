#include <utility>

#include "sensor/color_conversion.h"
#include "sensor/convert/depth_units.h"
#include "sensor/convert/folder_frames.h"
#include "sensor/convert/sinks.h"
#include "sensor/convert/staged_output.h"
#include "sensor/openni2/oni_writer.h"

namespace kino {
namespace {

constexpr double kOniMetresPerUnit = 0.001;

class OniSink final : public FrameSink {
  public:
    OniSink(StagedOutput output, std::unique_ptr<OniWriter> writer, ConvertInput input)
        : output_(std::move(output)), writer_(std::move(writer)), input_(std::move(input)) {
        losses_.state(
            "ONI knows a camera only by its field of view: principal points, distortion "
            "and the place of the cameras to each other are gone");
        losses_.state("times are whole microseconds");
    }

    bool takes_sets() const override { return true; }

    Result<void> put(const FrameSet& set) override {
        if (!set.depth) {
            losses_.add("moments without depth");
            return {};
        }
        DepthFrame depth;
        depth.header = set.depth->header;
        KINO_ASSIGN(depth.raw,
                    depth_in_units(*set.depth, kOniMetresPerUnit, *input_.geometry, losses_));
        ColorFrame color;
        const ColorFrame* beside = nullptr;
        const bool usable = set.color && set.color_paired && input_.rig.color;
        if (set.color && !usable) losses_.add("colour frames that belong to no depth frame");
        if (usable && repeats_.is_new(set.color->header)) {
            if (auto made = to_rgb8(*set.color, color); made) {
                beside = &color;
            } else if (set.color->format == PixelFormat::mjpeg) {
                losses_.add("colour frames with a damaged JPEG");
            } else {
                return made;
            }
        }
        KINO_TRY(writer_->write(depth, beside));
        count(StreamKind::depth);
        if (beside) count(StreamKind::color);
        if (set.infrared) add_unheld(StreamKind::infrared, losses_);
        if (set.bodies) add_unheld(StreamKind::bodies, losses_);
        if (set.motion) add_unheld(StreamKind::motion, losses_);
        if (set.pose_origin == PoseOrigin::trajectory) losses_.add("poses of the camera");
        return {};
    }

    Result<void> finish() override {
        if (written(StreamKind::depth) == 0) {
            return fail("there is no depth frame to write", output_.target().string());
        }
        KINO_TRY(writer_->close());
        writer_.reset();
        return output_.commit();
    }

  private:
    Result<void> to_rgb8(const ColorFrame& from, ColorFrame& to) {
        const bool plain = from.format == PixelFormat::rgba8 || from.format == PixelFormat::rgb8 ||
                           from.format == PixelFormat::gray8;
        if (!plain) {
            losses_.state("colour as the camera sent it (Bayer, YUV or JPEG) became RGB");
        }
        KINO_TRY(to_rgba8(from, image_));
        to.header = from.header;
        to.format = PixelFormat::rgb8;
        to.width = from.width;
        to.height = from.height;
        to.pitch = from.width * 3;
        to.bytes.resize(image_.size() * 3);
        for (std::size_t i = 0; i < image_.size(); ++i) {
            const Rgba8 pixel = image_.data()[i];
            to.bytes[3 * i] = pixel.r;
            to.bytes[3 * i + 1] = pixel.g;
            to.bytes[3 * i + 2] = pixel.b;
        }
        return {};
    }

    StagedOutput output_;
    std::unique_ptr<OniWriter> writer_;
    ConvertInput input_;
    Repeats repeats_;
    Image<Rgba8> image_;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_oni_sink(const std::filesystem::path& file,
                                                 const ConvertInput& input,
                                                 const SinkOptions& options) {
    KINO_ASSIGN(StagedOutput output, StagedOutput::file(file, options.replace));
    RigParameters rig = input.rig;
    double hz = 30;
    bool color = false;
    for (const StreamInfo& stream : input.source.streams) {
        if (stream.id.device != 0) continue;
        if (stream.id.kind == StreamKind::color) color = true;
        if (stream.id.kind == StreamKind::depth && stream.nominal_hz > 0) hz = stream.nominal_hz;
    }
    if (!color) rig.color.reset();
    KINO_ASSIGN(auto writer, OniWriter::create(output.path(), rig, hz));
    ConvertInput used = input;
    used.rig = rig;
    return std::make_unique<OniSink>(std::move(output), std::move(writer), std::move(used));
}

}  // namespace kino
