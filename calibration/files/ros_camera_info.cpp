#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "calibration/files/camera_text.h"
#include "calibration/files/yaml_numbers.h"

namespace kino {
namespace {

std::string matrix_text(std::string_view name, int rows, int columns,
                        const std::vector<double>& data) {
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, rows, columns,
                       joined_numbers(data));
}

// ROS names cameras by plain words; anything else could be read as YAML.
std::string plain_name(std::string_view name) {
    std::string out;
    for (const char c : name) {
        const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
        out += plain ? c : '_';
    }
    return out.empty() ? "camera" : out;
}

Result<const YamlNode*> need(const YamlNode& root, const char* key, const std::string& where) {
    if (const YamlNode* node = root.find(key)) return node;
    return fail(fmt::format("no {} is there", key), where);
}

}  // namespace

std::string ros_camera_info(const NamedCamera& named) {
    const CameraModel& c = named.camera;
    const std::vector<double> distortion = distortion_numbers(c);
    return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", c.width, c.height,
                       plain_name(named.name)) +
           matrix_text("camera_matrix", 3, 3, {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}) +
           fmt::format("distortion_model: {}\n",
                       distortion.size() == 5 ? "plumb_bob" : "rational_polynomial") +
           matrix_text("distortion_coefficients", 1, static_cast<int>(distortion.size()),
                       distortion) +
           matrix_text("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
           matrix_text("projection_matrix", 3, 4, {c.fx, 0, c.cx, 0, 0, c.fy, c.cy, 0, 0, 0, 1, 0});
}

Result<NamedCamera> read_ros_camera_info(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const YamlNode root, parse_plain_yaml(text, where));
    NamedCamera out;
    KINO_ASSIGN(const YamlNode* width, need(root, "image_width", where));
    KINO_ASSIGN(const YamlNode* height, need(root, "image_height", where));
    KINO_ASSIGN(out.camera.width, whole_number(*width, 1, 16384, where));
    KINO_ASSIGN(out.camera.height, whole_number(*height, 1, 16384, where));
    if (const YamlNode* name = root.find("camera_name")) out.name = name->scalar;
    KINO_ASSIGN(const YamlNode* matrix, need(root, "camera_matrix", where));
    KINO_ASSIGN(const auto k, matrix_numbers(*matrix, where));
    KINO_TRY(set_matrix(out.camera, k, where));
    KINO_ASSIGN(const YamlNode* model, need(root, "distortion_model", where));
    if (model->scalar != "plumb_bob" && model->scalar != "rational_polynomial") {
        return fail(fmt::format("the distortion model \"{}\" is not known", model->scalar), where);
    }
    KINO_ASSIGN(const YamlNode* distortion, need(root, "distortion_coefficients", where));
    KINO_ASSIGN(const auto d, matrix_numbers(*distortion, where));
    if (model->scalar == "plumb_bob" && d.size() > 5) {
        return fail(fmt::format("plumb_bob has five numbers, not {}", d.size()), where);
    }
    KINO_TRY(set_distortion(out.camera, d, where));
    KINO_TRY(validate(out.camera, where));
    return out;
}

}  // namespace kino
