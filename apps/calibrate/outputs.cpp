#include "apps/calibrate/outputs.h"

#include <fmt/format.h>

#include <utility>

#include "calibration/files/camera_text.h"
#include "calibration/report/overlay_picture.h"
#include "sensor/color_conversion.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/file_bytes.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

Result<void> write_text(const fs::path& path, const std::string& text) {
    return write_file_bytes(path, text.data(), text.size());
}

Result<void> make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return fail(error.message(), folder.string());
    return {};
}

}  // namespace

RigParameters rig_of(const Calibration& calibration, RigParameters base,
                     const glm::dvec2& depth_shift_px) {
    RigParameters rig = std::move(base);
    rig.depth = calibration.cameras[0].camera;
    rig.depth.cx -= depth_shift_px.x;
    rig.depth.cy -= depth_shift_px.y;
    rig.color.reset();
    rig.color_from_depth = {};
    rig.note.clear();
    if (calibration.cameras.size() == 2) {
        rig.color = calibration.cameras[1].camera;
        rig.color_from_depth = calibration.second_from_first;
    }
    return rig;
}

Result<void> write_bias_beside(const fs::path& rig_file, const std::optional<DepthBias>& bias,
                               const std::string& serial) {
    const fs::path file = bias_file_beside(rig_file);
    if (bias) {
        if (file.has_parent_path()) KINO_TRY(make_folder(file.parent_path()));
        return write_bias_file(file, *bias, serial);
    }
    std::error_code error;
    fs::remove(file, error);
    if (error) return fail(error.message(), file.string());
    return {};
}

void add_overlays(const DepthFrame& depth, const ColorFrame& color, const RigParameters& before,
                  const RigParameters& after, Report& report) {
    Image<Rgba8> photo;
    if (!to_rgba8(color, photo)) return;
    std::vector<ReportPicture> pictures;
    for (const auto& [rig, caption] :
         {std::pair(&before, "before: the calibration that came with the recording"),
          std::pair(&after, "after: this calibration")}) {
        const auto drawn = depth_over_color(depth, photo, *rig);
        if (!drawn) return;
        auto picture = report_picture(caption, *drawn);
        if (!picture) return;
        pictures.push_back(std::move(*picture));
    }
    report.overlays = std::move(pictures);
}

Result<void> write_outputs(const Outputs& outputs, const Report& report, const RigParameters& rig,
                           const std::optional<DepthBias>& bias) {
    if (!outputs.rig.empty()) {
        KINO_TRY(write_rig_file(outputs.rig, rig));
        KINO_TRY(write_bias_beside(outputs.rig, bias, rig.serial));
    }
    if (!outputs.report.empty()) KINO_TRY(write_report(outputs.report, report));
    std::vector<NamedCamera> cameras = {{report.calibration.cameras[0].name, rig.depth}};
    if (rig.color) cameras.push_back({report.calibration.cameras[1].name, *rig.color});
    if (!outputs.opencv.empty()) {
        OpenCvCalibration file{cameras, std::nullopt};
        if (rig.color) file.second_from_first = rig.color_from_depth;
        KINO_TRY(write_text(outputs.opencv, opencv_yaml(file)));
    }
    if (!outputs.ros.empty()) {
        KINO_TRY(make_folder(outputs.ros));
        for (const NamedCamera& camera : cameras) {
            KINO_TRY(write_text(outputs.ros / (camera.name + ".yaml"), ros_camera_info(camera)));
        }
    }
    if (!outputs.tum.empty()) {
        KINO_TRY(make_folder(outputs.tum));
        for (const NamedCamera& camera : cameras) {
            KINO_ASSIGN(const std::string text, tum_intrinsics(camera));
            KINO_TRY(write_text(outputs.tum / (camera.name + ".txt"), text));
        }
    }
    if (!outputs.k4a.empty()) {
        KINO_ASSIGN(const std::string text, rig_to_k4a(rig));
        KINO_TRY(write_text(outputs.k4a, text));
    }
    return {};
}

}  // namespace kino
