#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "sensor/convert/depth_units.h"
#include "sensor/convert/folder_frames.h"
#include "sensor/convert/sinks.h"
#include "sensor/convert/staged_output.h"
#include "sensor/file_bytes.h"
#include "sensor/png_io.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

class PngSink final : public FrameSink {
  public:
    PngSink(StagedOutput output, ConvertInput input, std::int64_t first_index)
        : output_(std::move(output)), input_(std::move(input)), index_(first_index) {}

    bool takes_sets() const override { return true; }

    Result<void> put(const FrameSet& set) override {
        if (!set.depth) {
            losses_.add("moments without depth");
            return {};
        }
        const DepthFrame& depth = *set.depth;
        KINO_TRY(check_size("depth", depth.raw.width(), depth.raw.height(), input_.rig.depth));
        if (times_.empty()) {
            unit_ = depth.unit;
            metres_per_unit_ = depth.metres_per_unit;
            first_time_ = set.time;
        }
        const TimeNs time = set.time - first_time_;
        if (!times_.empty() && time <= times_.back()) {
            losses_.add("moments whose time does not rise");
            return {};
        }
        const std::string name = fmt::format("{:06}.png", index_++);
        if (depth.unit == unit_ && unit_ == DepthUnit::kinect_disparity11) {
            KINO_TRY(write("depth", name, depth.raw));
        } else if (unit_ == DepthUnit::kinect_disparity11) {
            return fail("the unit of depth changes within the recording");
        } else {
            KINO_ASSIGN(const auto raw,
                        depth_in_units(depth, metres_per_unit_, *input_.geometry, losses_));
            KINO_TRY(write("depth", name, raw));
        }
        count(StreamKind::depth);
        times_.push_back(time);
        if (!depth.damaged_rows.empty()) {
            losses_.add("depth frames whose damaged rows are no longer marked");
        }
        KINO_TRY(put_color(set, name));
        if (set.infrared) {
            KINO_TRY(write("infrared", name, set.infrared->raw));
            count(StreamKind::infrared);
        }
        if (set.pose_origin == PoseOrigin::trajectory) losses_.add("poses of the camera");
        if (set.bodies) add_unheld(StreamKind::bodies, losses_);
        if (set.motion) add_unheld(StreamKind::motion, losses_);
        return {};
    }

    Result<void> finish() override {
        if (times_.empty()) {
            return fail("there is no depth frame to write", output_.target().string());
        }
        const std::string text = description();
        KINO_TRY(write_file_bytes(output_.path() / "kinoscope.json", text.data(), text.size()));
        return output_.commit();
    }

  private:
    Result<void> put_color(const FrameSet& set, const std::string& name) {
        if (!set.color) return {};
        if (!set.color_paired) {
            losses_.add("moments whose nearest colour frame is too far away in time");
            return {};
        }
        if (!input_.rig.color) {
            losses_.add("colour frames of a camera without calibration");
            return {};
        }
        KINO_TRY(check_size("colour", set.color->width, set.color->height, *input_.rig.color));
        KINO_TRY(make_folder("color"));
        if (auto written = write_color_png(output_.path() / "color" / name, *set.color, losses_);
            !written) {
            if (set.color->format != PixelFormat::mjpeg) return written;
            losses_.add("colour frames with a damaged JPEG");
            return {};
        }
        count(StreamKind::color);
        return {};
    }

    Result<void> write(const char* folder, const std::string& name,
                       const Image<std::uint16_t>& image) {
        KINO_TRY(make_folder(folder));
        return write_png_gray16(output_.path() / folder / name, image);
    }

    Result<void> make_folder(const char* name) {
        std::error_code error;
        fs::create_directory(output_.path() / name, error);
        if (error) return fail(error.message(), (output_.path() / name).string());
        return {};
    }

    std::string description() const {
        RigParameters rig = input_.rig;
        const bool color = written(StreamKind::color) > 0;
        if (!color) rig.color.reset();
        auto json = nlohmann::ordered_json::parse(rig_to_json(rig));
        json.erase("kinoscope_rig");
        json["kinoscope"] = 1;
        json["name"] = input_.source.name;
        json["licence"] = input_.source.licence;
        json["depth"]["dir"] = "depth";
        if (unit_ == DepthUnit::kinect_disparity11) {
            json["depth"]["unit"] = "kinect_disparity11";
        } else {
            json["depth"]["per_metre"] = counts_per_metre(metres_per_unit_);
        }
        if (color) json["color"]["dir"] = "color";
        json["times_ns"] = times_;
        return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    }

    StagedOutput output_;
    ConvertInput input_;
    std::int64_t index_;
    DepthUnit unit_ = DepthUnit::linear;
    double metres_per_unit_ = 0.001;
    TimeNs first_time_ = 0;
    std::vector<TimeNs> times_;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_png_sink(const fs::path& folder, const ConvertInput& input,
                                                 const SinkOptions& options) {
    KINO_ASSIGN(StagedOutput output, StagedOutput::folder(folder, options.replace));
    return std::make_unique<PngSink>(std::move(output), input, options.first_index);
}

}  // namespace kino
