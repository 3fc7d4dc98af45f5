#include "sensor/rig_json.h"

#include <array>
#include <utility>

#include "sensor/file_bytes.h"
#include "sensor/json_cursor.h"

namespace kino {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMaxRigBytes = std::size_t{1} << 20;

using CameraField = std::pair<const char*, double CameraModel::*>;
constexpr std::array<CameraField, 4> kPinholeFields = {{{"fx", &CameraModel::fx},
                                                        {"fy", &CameraModel::fy},
                                                        {"cx", &CameraModel::cx},
                                                        {"cy", &CameraModel::cy}}};
constexpr std::array<CameraField, 8> kDistortionFields = {{{"k1", &CameraModel::k1},
                                                           {"k2", &CameraModel::k2},
                                                           {"k3", &CameraModel::k3},
                                                           {"k4", &CameraModel::k4},
                                                           {"k5", &CameraModel::k5},
                                                           {"k6", &CameraModel::k6},
                                                           {"p1", &CameraModel::p1},
                                                           {"p2", &CameraModel::p2}}};

ordered_json camera_to_json(const CameraModel& camera) {
    ordered_json out = {{"width", camera.width}, {"height", camera.height}};
    for (const auto& [key, field] : kPinholeFields) out[key] = camera.*field;
    for (const auto& [key, field] : kDistortionFields) {
        if (camera.*field != 0) out[key] = camera.*field;
    }
    return out;
}

Result<CameraModel> camera_from_json(const JsonCursor& object) {
    KINO_TRY(object.only({"width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "k5",
                          "k6", "p1", "p2"}));
    CameraModel camera;
    for (const auto& [key, size] :
         {std::pair("width", &camera.width), std::pair("height", &camera.height)}) {
        KINO_ASSIGN(const JsonCursor member, object.member(key));
        KINO_ASSIGN(const std::int64_t value, member.integer(1, 16384));
        *size = static_cast<int>(value);
    }
    for (const auto& [key, field] : kPinholeFields) {
        KINO_ASSIGN(const JsonCursor member, object.member(key));
        KINO_ASSIGN(camera.*field, member.number());
    }
    for (const auto& [key, field] : kDistortionFields) KINO_TRY(object.read(key, camera.*field));
    return camera;
}

template <std::size_t n>
Result<std::array<double, n>> numbers(const JsonCursor& list) {
    KINO_ASSIGN(const auto items, list.items(n, n));
    std::array<double, n> out{};
    for (std::size_t i = 0; i < n; ++i) {
        KINO_ASSIGN(out[i], items[i].number());
    }
    return out;
}

Result<Pose> pose_from_json(const JsonCursor& object) {
    KINO_TRY(object.only({"rotation_wxyz", "translation_m"}));
    Pose pose;
    if (const auto rotation = object.find("rotation_wxyz")) {
        KINO_ASSIGN(const auto q, numbers<4>(*rotation));
        pose.rotation = glm::dquat(q[0], q[1], q[2], q[3]);
    }
    if (const auto translation = object.find("translation_m")) {
        KINO_ASSIGN(const auto t, numbers<3>(*translation));
        pose.translation = {t[0], t[1], t[2]};
    }
    return pose;
}

Result<DisparityParameters> disparity_from_json(const JsonCursor& object) {
    KINO_TRY(object.only({"const_shift", "reference_pixel_size_mm", "reference_distance_cm",
                          "emitter_distance_cm"}));
    DisparityParameters out;
    KINO_TRY(object.read("const_shift", out.const_shift));
    KINO_TRY(object.read("reference_pixel_size_mm", out.reference_pixel_size_mm));
    KINO_TRY(object.read("reference_distance_cm", out.reference_distance_cm));
    KINO_TRY(object.read("emitter_distance_cm", out.emitter_distance_cm));
    return out;
}

}  // namespace

std::string rig_to_json(const RigParameters& rig) {
    ordered_json out = {{"kinoscope_rig", 1}, {"serial", rig.serial}, {"note", rig.note}};
    out["cameras"]["depth"] = camera_to_json(rig.depth);
    if (rig.color) out["cameras"]["color"] = camera_to_json(*rig.color);
    const Pose& pose = rig.color_from_depth;
    out["color_from_depth"] = {
        {"rotation_wxyz", {pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z}},
        {"translation_m", {pose.translation.x, pose.translation.y, pose.translation.z}}};
    out["disparity"] = {{"const_shift", rig.disparity.const_shift},
                        {"reference_pixel_size_mm", rig.disparity.reference_pixel_size_mm},
                        {"reference_distance_cm", rig.disparity.reference_distance_cm},
                        {"emitter_distance_cm", rig.disparity.emitter_distance_cm}};
    out["range_m"] = {rig.min_depth_m, rig.max_depth_m};
    // Serial and note may hold bytes that are not UTF-8; they must not throw here.
    return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<RigParameters> read_rig_members(const JsonCursor& object) {
    RigParameters rig;
    KINO_TRY(object.read("serial", rig.serial));
    KINO_TRY(object.read("note", rig.note));
    KINO_ASSIGN(const JsonCursor cameras, object.member("cameras"));
    KINO_TRY(cameras.only({"depth", "color"}));
    KINO_ASSIGN(const JsonCursor depth, cameras.member("depth"));
    KINO_ASSIGN(rig.depth, camera_from_json(depth));
    const auto color = cameras.find("color");
    if (color) {
        KINO_ASSIGN(rig.color, camera_from_json(*color));
    }
    const auto pose = object.find("color_from_depth");
    if (pose) {
        KINO_ASSIGN(rig.color_from_depth, pose_from_json(*pose));
    }
    bool registered = false;
    KINO_TRY(object.read("depth_is_registered_to_color", registered));
    if (registered) {
        if (color || pose) {
            return object.error(
                "depth_is_registered_to_color leaves no room for cameras/color or "
                "color_from_depth",
                "state the shared camera as cameras/depth alone");
        }
        rig.color = rig.depth;
    }
    if (const auto disparity = object.find("disparity")) {
        KINO_ASSIGN(rig.disparity, disparity_from_json(*disparity));
    }
    if (const auto range = object.find("range_m")) {
        KINO_ASSIGN(const auto limits, numbers<2>(*range));
        rig.min_depth_m = limits[0];
        rig.max_depth_m = limits[1];
    }
    return rig;
}

Result<void> validate_rig_of(const RigParameters& rig, const std::string& where) {
    Result<void> good = validate(rig);
    if (!good) good.error().where = where + ": " + good.error().where;
    return good;
}

Result<RigParameters> rig_from_json(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const auto document, parse_json(text, where));
    const JsonCursor root(document, where);
    KINO_TRY(root.only({"kinoscope_rig", "serial", "note", "cameras", "color_from_depth",
                        "disparity", "range_m"}));
    KINO_ASSIGN(const JsonCursor version, root.member("kinoscope_rig"));
    KINO_TRY(version.integer(1, 1));
    KINO_ASSIGN(RigParameters rig, read_rig_members(root));
    KINO_TRY(validate_rig_of(rig, where));
    return rig;
}

Result<RigParameters> read_rig_file(const std::filesystem::path& path) {
    KINO_ASSIGN(const std::string text, read_file_text(path, kMaxRigBytes));
    return rig_from_json(text, path.string());
}

Result<void> write_rig_file(const std::filesystem::path& path, const RigParameters& rig) {
    KINO_TRY(validate(rig));
    const std::string text = rig_to_json(rig);
    return write_file_bytes(path, text.data(), text.size());
}

}  // namespace kino
