#include <fmt/format.h>

#include <cmath>
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

constexpr double kTumPerMetre = 5000;

std::string seconds(TimeNs time) {
    return fmt::format("{}.{:09}", time / kNsPerSecond, time % kNsPerSecond);
}

/// The benchmark's world has z up: (x, y, z) -> (x, -z, y), the inverse of sensor/trajectory.cpp.
Pose z_up(const Pose& world_from_depth) {
    static const Pose z_up_from_y_up{glm::dquat(std::sqrt(0.5), std::sqrt(0.5), 0, 0),
                                     glm::dvec3(0)};
    return z_up_from_y_up * world_from_depth;
}

class TumSink final : public FrameSink {
  public:
    TumSink(StagedOutput output, ConvertInput input, const SinkOptions& options)
        : output_(std::move(output)), input_(std::move(input)), options_(options) {}

    bool takes_sets() const override { return false; }

    Result<void> put(StreamId id, const StreamFrame& frame,
                     const std::optional<Pose>& pose) override {
        if (id.device != 0) {
            losses_.add("frames of further devices");
            return {};
        }
        if (const auto* depth = std::get_if<0>(&frame)) return put_depth(**depth, pose);
        if (const auto* color = std::get_if<1>(&frame)) {
            // The clock is that of depth: colour that comes first has to wait.
            if (!clock_.is_set()) {
                constexpr std::size_t kMost = 64;
                if (early_.size() < kMost) {
                    early_.push_back(*color);
                } else {
                    losses_.add("colour frames before the first depth frame");
                }
                return {};
            }
            return put_color(**color);
        }
        add_unheld(id.kind, losses_);
        return {};
    }

    Result<void> finish() override {
        if (depth_list_.empty()) {
            return fail("there is no depth frame to write", output_.target().string());
        }
        losses_.add("colour frames before the first depth frame",
                    static_cast<std::int64_t>(early_.size()));
        KINO_TRY(write("depth.txt", "# depth, seconds and file\n" + depth_list_));
        if (!color_list_.empty()) {
            KINO_TRY(write("rgb.txt", "# colour, seconds and file\n" + color_list_));
        }
        if (!pose_list_.empty()) {
            KINO_TRY(write("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n" + pose_list_));
        }
        KINO_TRY(write("calibration.json", calibration()));
        return output_.commit();
    }

  private:
    Result<void> put_depth(const DepthFrame& frame, const std::optional<Pose>& pose) {
        KINO_TRY(check_size("depth", frame.raw.width(), frame.raw.height(), input_.rig.depth));
        if (!clock_.is_set()) {
            clock_.set_by(frame.header);
            const bool linear = frame.unit == DepthUnit::linear;
            per_metre_ = options_.depth_per_metre.value_or(
                linear ? counts_per_metre(frame.metres_per_unit) : kTumPerMetre);
            if (!(per_metre_ >= 1 && per_metre_ <= 1e6)) {
                return fail(fmt::format("{} counts a metre do not fit the format", per_metre_), {},
                            "--scale 5000");
            }
            for (const auto& color : std::exchange(early_, {})) KINO_TRY(put_color(*color));
        }
        const TimeNs time = clock_(frame.header);
        if (time < 0 || time <= last_depth_) {
            losses_.add("depth frames whose time does not rise");
            return {};
        }
        KINO_TRY(make_folder("depth"));
        KINO_ASSIGN(const auto raw,
                    depth_in_units(frame, 1 / per_metre_, *input_.geometry, losses_));
        const std::string name = "depth/" + seconds(time) + ".png";
        KINO_TRY(write_png_gray16(output_.path() / name, raw));
        depth_list_ += seconds(time) + " " + name + "\n";
        if (pose) {
            const Pose p = z_up(*pose);
            pose_list_ += fmt::format("{} {} {} {} {} {} {} {}\n", seconds(time), p.translation.x,
                                      p.translation.y, p.translation.z, p.rotation.x, p.rotation.y,
                                      p.rotation.z, p.rotation.w);
        }
        if (!frame.damaged_rows.empty()) {
            losses_.add("depth frames whose damaged rows are no longer marked");
        }
        last_depth_ = time;
        count(StreamKind::depth);
        return {};
    }

    Result<void> put_color(const ColorFrame& frame) {
        const TimeNs time = clock_(frame.header);
        if (time < 0 || time <= last_color_) {
            losses_.add("colour frames whose time does not rise");
            return {};
        }
        if (!input_.rig.color) {
            losses_.add("colour frames of a camera without calibration");
            return {};
        }
        KINO_TRY(check_size("colour", frame.width, frame.height, *input_.rig.color));
        KINO_TRY(make_folder("rgb"));
        const std::string name = "rgb/" + seconds(time) + ".png";
        if (auto written = write_color_png(output_.path() / name, frame, losses_); !written) {
            // A camera's broken JPEG is the loss of a picture, not of a recording.
            if (frame.format != PixelFormat::mjpeg) return written;
            losses_.add("colour frames with a damaged JPEG");
            return {};
        }
        color_list_ += seconds(time) + " " + name + "\n";
        last_color_ = time;
        count(StreamKind::color);
        return {};
    }

    Result<void> make_folder(const char* name) {
        std::error_code error;
        fs::create_directory(output_.path() / name, error);
        if (error) return fail(error.message(), (output_.path() / name).string());
        return {};
    }

    Result<void> write(const char* name, const std::string& text) {
        return write_file_bytes(output_.path() / name, text.data(), text.size());
    }

    std::string calibration() const {
        RigParameters rig = input_.rig;
        if (color_list_.empty()) rig.color.reset();
        auto json = nlohmann::ordered_json::parse(rig_to_json(rig));
        json.erase("kinoscope_rig");
        json["name"] = input_.source.name;
        json["licence"] = input_.source.licence;
        json["depth_per_metre"] = per_metre_;
        return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    }

    StagedOutput output_;
    ConvertInput input_;
    SinkOptions options_;
    FileClock clock_;
    double per_metre_ = kTumPerMetre;
    std::vector<std::shared_ptr<const ColorFrame>> early_;
    TimeNs last_depth_ = -1;
    TimeNs last_color_ = -1;
    std::string depth_list_;
    std::string color_list_;
    std::string pose_list_;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_tum_sink(const fs::path& folder, const ConvertInput& input,
                                                 const SinkOptions& options) {
    KINO_ASSIGN(StagedOutput output, StagedOutput::folder(folder, options.replace));
    return std::make_unique<TumSink>(std::move(output), input, options);
}

}  // namespace kino
