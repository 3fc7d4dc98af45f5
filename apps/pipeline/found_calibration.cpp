#include "apps/pipeline/found_calibration.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <utility>

#include "calibration/files/calibration_store.h"
#include "calibration/projection.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

constexpr const char* kGoWithout = "--calibration none goes without it";

Result<CameraModel> fit_camera(const CameraModel& camera, const CameraModel& own,
                               const char* name) {
    if (camera.width == own.width && camera.height == own.height) return camera;
    // Another mode of the same camera. A crop would need to know from where.
    if (static_cast<std::int64_t>(camera.width) * own.height !=
        static_cast<std::int64_t>(own.width) * camera.height) {
        return fail(fmt::format("the {} camera is calibrated at {}x{}, the source sends {}x{}",
                                name, camera.width, camera.height, own.width, own.height),
                    {}, kGoWithout);
    }
    return scaled(camera, own.width, own.height);
}

}  // namespace

Result<RigParameters> fit_calibration(RigParameters file, const RigParameters& own,
                                      const SourceInfo& info) {
    if (info.uri.find("registration=on") != std::string::npos) {
        return fail("the device has registered depth to colour itself", {},
                    "open it without registration=on");
    }
    KINO_ASSIGN(file.depth, fit_camera(file.depth, own.depth, "depth"));
    if (own.color && file.color) {
        KINO_ASSIGN(file.color, fit_camera(*file.color, *own.color, "colour"));
    } else {
        file.color = own.color;
        file.color_from_depth = own.color_from_depth;
    }
    if (file.serial.empty()) file.serial = own.serial;
    return file;
}

void tell_of(const FoundCalibration& calibration) {
    if (calibration.file.empty()) return;
    const std::string& serial = calibration.rig.serial;
    fmt::print(stderr, "kinoscope: calibration{}{} from {}\n", serial.empty() ? "" : " of ", serial,
               calibration.file);
}

Result<FoundCalibration> find_calibration(Source& source, const std::string& choice) {
    const SourceInfo& info = source.info();
    KINO_ASSIGN(RigParameters own, source.calibration());
    if (choice == "none") return FoundCalibration{std::move(own)};
    std::string file = choice;
    std::optional<RigParameters> rig;
    if (!choice.empty()) {
        KINO_ASSIGN(rig, read_rig_file(choice));
    } else if (source.timeline() == nullptr) {
        // Without a home there is no place to look.
        const auto folder = calibration_folder();
        const std::string& serial = info.serial.empty() ? own.serial : info.serial;
        if (!folder || serial.empty()) return FoundCalibration{std::move(own)};
        file = calibration_file(*folder, serial).string();
        auto stored = stored_calibration(*folder, serial);
        if (!stored) return fail(stored.error().what, stored.error().where, kGoWithout);
        rig = *std::move(stored);
    }
    if (!rig) return FoundCalibration{std::move(own)};
    auto fitted = fit_calibration(*std::move(rig), own, info);
    if (!fitted) return fail(fitted.error().what, file, fitted.error().hint);
    return FoundCalibration{*std::move(fitted), std::move(file)};
}

}  // namespace kino
