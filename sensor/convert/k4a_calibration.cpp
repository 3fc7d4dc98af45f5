#include "sensor/convert/k4a_calibration.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <span>

#include "sensor/json_cursor.h"

namespace kino {
namespace {

using nlohmann::ordered_json;

// The mode tables of Azure-Kinect-Sensor-SDK, transformation/mode_specific_calibration.c.
constexpr std::array<K4aMode, 4> kDepthModes = {{{"NFOV_2X2BINNED", 512, 512, 96, 90, 320, 288},
                                                 {"NFOV_UNBINNED", 1024, 1024, 192, 180, 640, 576},
                                                 {"WFOV_2X2BINNED", 512, 512, 0, 0, 512, 512},
                                                 {"WFOV_UNBINNED", 1024, 1024, 0, 0, 1024, 1024}}};
constexpr std::array<K4aMode, 6> kColorModes = {{{"720P", 1280, 960, 0, 120, 1280, 720},
                                                 {"1080P", 1920, 1440, 0, 180, 1920, 1080},
                                                 {"1440P", 2560, 1920, 0, 240, 2560, 1440},
                                                 {"1536P", 2048, 1536, 0, 0, 2048, 1536},
                                                 {"2160P", 3840, 2880, 0, 360, 3840, 2160},
                                                 {"3072P", 4096, 3072, 0, 0, 4096, 3072}}};
constexpr std::size_t kParameters = 14;
constexpr const char* kBrownConrady = "CALIBRATION_LensDistortionModelBrownConrady";
constexpr const char* kRational6kt = "CALIBRATION_LensDistortionModelRational6KT";

const K4aMode* mode_of(std::span<const K4aMode> modes, int width, int height) {
    for (const K4aMode& mode : modes) {
        if (mode.width == width && mode.height == height) return &mode;
    }
    return nullptr;
}

// A file's number is a share of the calibrated picture. Rounded once, so that reading what
// to_share() wrote gives the same pixels wherever any number of the file would.
double to_px(double share, int whole_px, double first_px) {
    return static_cast<double>(static_cast<long double>(share) * whole_px - first_px);
}

double to_share(double px, int whole_px, double first_px) {
    const auto near = static_cast<double>((static_cast<long double>(px) + first_px) / whole_px);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double above = near;
    double below = near;
    for (int i = 0; i < 4; ++i) {
        if (to_px(above, whole_px, first_px) == px) return above;
        if (to_px(below, whole_px, first_px) == px) return below;
        above = std::nextafter(above, kInfinity);
        below = std::nextafter(below, -kInfinity);
    }
    // The file's numbers lie further apart here than the pixels'.
    return near;
}

// The same rotation to 2e-15, such that the matrix made of it leads back to it: its largest part is
// positive and follows from the others, and those are whole multiples of 2^-48.
glm::dquat settled(glm::dquat q) {
    constexpr double kGrid = 281474976710656.0;
    int largest = 0;
    for (int i = 1; i < 4; ++i) {
        if (std::abs(q[i]) > std::abs(q[largest])) largest = i;
    }
    if (q[largest] < 0) q = -q;
    double rest = 1;
    for (int i = 0; i < 4; ++i) {
        if (i == largest) continue;
        q[i] = std::round(q[i] * kGrid) / kGrid;
        rest -= q[i] * q[i];
    }
    q[largest] = std::sqrt(rest);
    return q;
}

glm::dquat rotation_of(const glm::dmat3& matrix) {
    return settled(glm::normalize(glm::quat_cast(matrix)));
}

struct K4aCamera {
    CameraModel camera;
    Pose from_depth;
    bool rational_6kt = false;
    bool shifted_distortion = false;
};

Result<Pose> read_rt(const JsonCursor& owner) {
    KINO_ASSIGN(const JsonCursor rt, owner.member("Rt"));
    KINO_ASSIGN(const JsonCursor rotation, rt.member("Rotation"));
    KINO_ASSIGN(const JsonCursor translation, rt.member("Translation"));
    KINO_ASSIGN(const auto r, rotation.items(9, 9));
    KINO_ASSIGN(const auto t, translation.items(3, 3));
    glm::dmat3 matrix;
    for (int i = 0; i < 9; ++i) {
        KINO_ASSIGN(matrix[i % 3][i / 3], r[static_cast<std::size_t>(i)].number());
    }
    Pose pose;
    for (int i = 0; i < 3; ++i) {
        KINO_ASSIGN(pose.translation[i], t[static_cast<std::size_t>(i)].number());
    }
    const glm::dmat3 squared = matrix * glm::transpose(matrix);
    for (int i = 0; i < 9; ++i) {
        // Floats of a factory; further off is no rotation.
        const double expected = i / 3 == i % 3 ? 1 : 0;
        if (!(std::abs(squared[i / 3][i % 3] - expected) < 1e-3)) {
            return rt.error("Rotation is not a rotation");
        }
    }
    if (!(glm::determinant(matrix) > 0)) return rt.error("Rotation is a mirror");
    pose.rotation = rotation_of(matrix);
    return pose;
}

Result<K4aCamera> read_camera(const JsonCursor& object, const K4aMode& mode, bool color) {
    KINO_ASSIGN(const JsonCursor intrinsics, object.member("Intrinsics"));
    KINO_ASSIGN(const JsonCursor type, intrinsics.member("ModelType"));
    KINO_ASSIGN(const std::string model, type.text());
    K4aCamera out;
    out.rational_6kt = model == kRational6kt;
    if (!out.rational_6kt && model != kBrownConrady) {
        return type.error(fmt::format("the lens model {} is not known", model));
    }
    KINO_ASSIGN(const JsonCursor list, intrinsics.member("ModelParameters"));
    KINO_ASSIGN(const auto items, list.items(kParameters, 32));
    std::array<double, kParameters> v{};
    for (std::size_t i = 0; i < kParameters; ++i) {
        KINO_ASSIGN(v[i], items[i].number());
    }
    if (color) {
        KINO_ASSIGN(const JsonCursor width, object.member("SensorWidth"));
        KINO_ASSIGN(const JsonCursor height, object.member("SensorHeight"));
        KINO_ASSIGN(const std::int64_t w, width.integer(1, 65536));
        KINO_ASSIGN(const std::int64_t h, height.integer(1, 65536));
        // Early devices were calibrated on 4096 x 2304, rows 384 on of 4096 x 3072.
        if (w * 9 / 16 == h) {
            v[1] = (v[1] * 2304 + 384) / 3072;
            v[3] = v[3] * 2304 / 3072;
        } else if (w * 3 / 4 != h) {
            return width.error("the calibrated picture is neither 4:3 nor 16:9");
        }
    }
    CameraModel& camera = out.camera;
    camera = {.width = mode.width,
              .height = mode.height,
              .fx = to_px(v[2], mode.binned_width, 0),
              .fy = to_px(v[3], mode.binned_height, 0),
              .cx = to_px(v[0], mode.binned_width, mode.crop_x + 0.5),
              .cy = to_px(v[1], mode.binned_height, mode.crop_y + 0.5),
              .k1 = v[4],
              .k2 = v[5],
              .k3 = v[6],
              .k4 = v[7],
              .k5 = v[8],
              .k6 = v[9],
              .p1 = v[13],
              .p2 = v[12]};
    out.shifted_distortion = v[10] != 0 || v[11] != 0;
    KINO_ASSIGN(out.from_depth, read_rt(object));
    return out;
}

ordered_json camera_to_json(const CameraModel& camera, const K4aMode& mode, const Pose& from_depth,
                            bool color) {
    ordered_json out;
    out["Intrinsics"] = {{"ModelParameterCount", kParameters},
                         {"ModelParameters",
                          {to_share(camera.cx, mode.binned_width, mode.crop_x + 0.5),
                           to_share(camera.cy, mode.binned_height, mode.crop_y + 0.5),
                           to_share(camera.fx, mode.binned_width, 0),
                           to_share(camera.fy, mode.binned_height, 0), camera.k1, camera.k2,
                           camera.k3, camera.k4, camera.k5, camera.k6, 0, 0, camera.p2, camera.p1}},
                         {"ModelType", kBrownConrady}};
    out["Location"] = color ? "CALIBRATION_CameraLocationPV0" : "CALIBRATION_CameraLocationD0";
    out["Purpose"] =
        color ? "CALIBRATION_CameraPurposePhotoVideo" : "CALIBRATION_CameraPurposeDepth";
    out["MetricRadius"] = color ? 0.0 : 1.74;
    const glm::dmat3 matrix = glm::mat3_cast(settled(from_depth.rotation));
    ordered_json rotation = ordered_json::array();
    for (int i = 0; i < 9; ++i) rotation.push_back(matrix[i % 3][i / 3]);
    const glm::dvec3& t = from_depth.translation;
    out["Rt"] = {{"Rotation", rotation}, {"Translation", {t.x, t.y, t.z}}};
    out["SensorHeight"] = color ? 3072 : 1024;
    out["SensorWidth"] = color ? 4096 : 1024;
    out["Shutter"] = "CALIBRATION_ShutterTypeUndefined";
    out["ThermalAdjustmentParams"] = {{"Params", std::array<double, 12>{}}};
    return out;
}

void add_note(std::string& note, std::string_view text) {
    note += fmt::format("{}{}", note.empty() ? "" : "; ", text);
}

}  // namespace

const K4aMode* k4a_depth_mode(int width, int height) {
    return mode_of(kDepthModes, width, height);
}

const K4aMode* k4a_color_mode(int width, int height) {
    return mode_of(kColorModes, width, height);
}

Result<RigParameters> rig_from_k4a(std::string_view json, PixelSize depth,
                                   std::optional<PixelSize> color, const std::string& where) {
    // The SDK ends its attachment with a zero byte.
    while (!json.empty() && json.back() == '\0') json.remove_suffix(1);
    const K4aMode* depth_mode = k4a_depth_mode(depth.width, depth.height);
    if (!depth_mode) {
        return fail(fmt::format("no depth mode has {}x{} pixels", depth.width, depth.height),
                    where);
    }
    const K4aMode* color_mode = color ? k4a_color_mode(color->width, color->height) : nullptr;
    if (color && !color_mode) {
        return fail(fmt::format("no colour mode has {}x{} pixels", color->width, color->height),
                    where);
    }
    KINO_ASSIGN(const auto document, parse_json(json, where));
    const JsonCursor root(document, where);
    KINO_ASSIGN(const JsonCursor calibration, root.member("CalibrationInformation"));
    KINO_ASSIGN(const JsonCursor cameras, calibration.member("Cameras"));
    KINO_ASSIGN(const auto list, cameras.items(1, 16));
    RigParameters rig = typical_k4a_rig(depth, color);
    rig.note.clear();
    bool have_depth = false;
    bool have_color = false;
    for (const JsonCursor& entry : list) {
        KINO_ASSIGN(const JsonCursor location, entry.member("Location"));
        KINO_ASSIGN(const std::string place, location.text());
        const bool is_depth = place == "CALIBRATION_CameraLocationD0";
        const bool is_color = place == "CALIBRATION_CameraLocationPV0" && color_mode != nullptr;
        if (!is_depth && !is_color) continue;
        KINO_ASSIGN(const K4aCamera camera,
                    read_camera(entry, is_depth ? *depth_mode : *color_mode, is_color));
        if (is_depth) {
            rig.depth = camera.camera;
            have_depth = true;
        } else {
            rig.color = camera.camera;
            rig.color_from_depth = camera.from_depth;
            have_color = true;
        }
        if (camera.rational_6kt && (camera.camera.p1 != 0 || camera.camera.p2 != 0)) {
            add_note(rig.note, "the lens model Rational6KT is taken for Brown-Conrady");
        }
        if (camera.shifted_distortion) {
            add_note(rig.note, "the centre of distortion is taken for the principal point");
        }
    }
    if (!have_depth) return cameras.error("no camera CALIBRATION_CameraLocationD0");
    if (color_mode && !have_color) {
        return cameras.error("no camera CALIBRATION_CameraLocationPV0");
    }
    KINO_TRY(validate(rig));
    return rig;
}

Result<std::string> rig_to_k4a(const RigParameters& rig) {
    const K4aMode* depth = k4a_depth_mode(rig.depth.width, rig.depth.height);
    const K4aMode* color =
        rig.color ? k4a_color_mode(rig.color->width, rig.color->height) : nullptr;
    if (!depth || (rig.color && !color)) {
        return fail("an Azure Kinect has no mode of these sizes");
    }
    ordered_json cameras = ordered_json::array();
    cameras.push_back(camera_to_json(rig.depth, *depth, {}, false));
    if (color) cameras.push_back(camera_to_json(*rig.color, *color, rig.color_from_depth, true));
    ordered_json out;
    out["CalibrationInformation"] = {{"Cameras", cameras},
                                     {"InertialSensors", ordered_json::array()}};
    return out.dump();
}

std::optional<Pose> k4a_accelerometer(std::string_view json) {
    while (!json.empty() && json.back() == '\0') json.remove_suffix(1);
    const auto document = parse_json(json, {});
    if (!document) return std::nullopt;
    const auto calibration = JsonCursor(*document, {}).find("CalibrationInformation");
    const auto sensors = calibration ? calibration->find("InertialSensors") : std::nullopt;
    const auto list = sensors ? sensors->items(0, 16) : Result<std::vector<JsonCursor>>{};
    if (!list) return std::nullopt;
    for (const JsonCursor& sensor : *list) {
        const auto type = sensor.find("SensorType");
        const auto name = type ? type->text() : Result<std::string>{};
        if (!name || *name != "CALIBRATION_InertialSensorType_Accelerometer") continue;
        if (auto pose = read_rt(sensor)) return *pose;
    }
    return std::nullopt;
}

RigParameters typical_k4a_rig(PixelSize depth, std::optional<PixelSize> color) {
    const auto camera = [](PixelSize size, double focal_share) {
        return CameraModel{.width = size.width,
                           .height = size.height,
                           .fx = size.width * focal_share,
                           .fy = size.width * focal_share,
                           .cx = (size.width - 1) / 2.0,
                           .cy = (size.height - 1) / 2.0};
    };
    RigParameters rig;
    // 504 px at 640 wide (narrow), 504 px at 1024 (wide); colour 607 px at 1280.
    rig.depth = camera(depth, depth.width == depth.height ? 504.0 / 1024 : 504.0 / 640);
    if (color) rig.color = camera(*color, 607.0 / 1280);
    rig.color_from_depth.translation = {-0.032, -0.002, 0.004};
    rig.min_depth_m = 0.15;
    rig.max_depth_m = 10;
    rig.note = "no calibration in the file: typical values of an Azure Kinect are assumed";
    return rig;
}

}  // namespace kino
