#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "calibration/files/camera_text.h"
#include "calibration/files/yaml_numbers.h"

namespace kino {
namespace {

using Size = std::pair<int, int>;

std::string matrix_text(std::string_view name, std::size_t rows, std::size_t columns, char type,
                        const std::vector<double>& data) {
    return fmt::format(
        "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: {}\n   data: [ {} ]\n", name, rows,
        columns, type, joined_numbers(data));
}

std::string camera_text(const CameraModel& c, std::string_view matrix,
                        std::string_view distortion) {
    const auto numbers = distortion_numbers(c);
    return matrix_text(matrix, 3, 3, 'd', {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}) +
           matrix_text(distortion, 1, numbers.size(), 'd', numbers);
}

const YamlNode* first_of(const YamlNode& root, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
        if (const YamlNode* node = root.find(key)) return node;
    }
    return nullptr;
}

struct Names {
    const char* name;
    std::initializer_list<const char*> matrix;
    std::initializer_list<const char*> distortion;
    std::initializer_list<const char*> size;
};

Result<std::optional<NamedCamera>> read_camera(const YamlNode& root, const Names& names,
                                               const std::string& where,
                                               const std::optional<Size>& size_if_missing) {
    const YamlNode* matrix = first_of(root, names.matrix);
    if (!matrix) return std::nullopt;
    NamedCamera out{names.name, {}};
    KINO_ASSIGN(const auto k, matrix_numbers(*matrix, where));
    KINO_TRY(set_matrix(out.camera, k, where));
    if (const YamlNode* distortion = first_of(root, names.distortion)) {
        KINO_ASSIGN(const auto d, matrix_numbers(*distortion, where));
        KINO_TRY(set_distortion(out.camera, d, where));
    }
    if (const YamlNode* size = first_of(root, names.size)) {
        KINO_ASSIGN(const auto s, matrix_numbers(*size, where));
        if (s.size() != 2 || !(s[0] >= 1) || !(s[1] >= 1) || s[0] > 16384 || s[1] > 16384) {
            return fail("a picture size is two numbers from 1 to 16384", where);
        }
        out.camera.width = static_cast<int>(s[0]);
        out.camera.height = static_cast<int>(s[1]);
    } else if (root.find("image_width") && root.find("image_height")) {
        KINO_ASSIGN(out.camera.width, whole_number(*root.find("image_width"), 1, 16384, where));
        KINO_ASSIGN(out.camera.height, whole_number(*root.find("image_height"), 1, 16384, where));
    } else if (size_if_missing) {
        out.camera.width = size_if_missing->first;
        out.camera.height = size_if_missing->second;
    } else {
        return fail("the file does not say how large the picture is", where, "state its size");
    }
    KINO_TRY(validate(out.camera, where));
    return out;
}

Result<Pose> read_pose(const YamlNode& rotation, const YamlNode& translation,
                       const std::string& where) {
    KINO_ASSIGN(const auto r, matrix_numbers(rotation, where));
    KINO_ASSIGN(const auto t, matrix_numbers(translation, where));
    if (r.size() != 9 || t.size() != 3) return fail("R is 3 x 3 and T has three numbers", where);
    glm::dmat3 matrix;
    for (std::size_t i = 0; i < 9; ++i) {
        matrix[static_cast<int>(i % 3)][static_cast<int>(i / 3)] = r[i];
    }
    const glm::dmat3 square = matrix * glm::transpose(matrix);
    for (int i = 0; i < 9; ++i) {
        const double off = std::abs(square[i / 3][i % 3] - (i / 3 == i % 3 ? 1 : 0));
        if (!(off < 1e-3)) return fail("R is not a rotation", where);
    }
    if (!(glm::determinant(matrix) > 0)) return fail("R is a mirror", where);
    const Pose pose{glm::normalize(glm::quat_cast(matrix)), {t[0], t[1], t[2]}};
    if (!is_valid(pose)) return fail("R and T are no pose", where);
    return pose;
}

}  // namespace

std::string opencv_yaml(const OpenCvCalibration& calibration) {
    std::string out = "%YAML:1.0\n---\n";
    const CameraModel& first = calibration.cameras.at(0).camera;
    if (calibration.cameras.size() == 1) {
        return out + fmt::format("image_width: {}\nimage_height: {}\n", first.width, first.height) +
               camera_text(first, "camera_matrix", "distortion_coefficients");
    }
    const CameraModel& second = calibration.cameras.at(1).camera;
    const auto size = [](const CameraModel& c) {
        return std::vector<double>{static_cast<double>(c.width), static_cast<double>(c.height)};
    };
    out += matrix_text("size1", 1, 2, 'i', size(first)) + camera_text(first, "M1", "D1") +
           matrix_text("size2", 1, 2, 'i', size(second)) + camera_text(second, "M2", "D2");
    if (!calibration.second_from_first) return out;
    const glm::dmat3 m = glm::mat3_cast(calibration.second_from_first->rotation);
    std::vector<double> r;
    for (int i = 0; i < 9; ++i) r.push_back(m[i % 3][i / 3]);
    const glm::dvec3& t = calibration.second_from_first->translation;
    return out + matrix_text("R", 3, 3, 'd', r) + matrix_text("T", 3, 1, 'd', {t.x, t.y, t.z});
}

Result<OpenCvCalibration> read_opencv_yaml(std::string_view text, const std::string& where,
                                           std::optional<Size> size_if_missing) {
    KINO_ASSIGN(const YamlNode root, parse_plain_yaml(text, where));
    const std::array<std::array<Names, 2>, 2> pairs = {
        {{{{"first", {"M1"}, {"D1"}, {"size1"}}, {"second", {"M2"}, {"D2"}, {"size2"}}}},
         {{{"depth", {"depth_intrinsics"}, {"depth_distortion"}, {"depth_size"}},
           {"color", {"rgb_intrinsics"}, {"rgb_distortion"}, {"rgb_size"}}}}}};
    OpenCvCalibration out;
    for (const auto& pair : pairs) {
        KINO_ASSIGN(auto first, read_camera(root, pair[0], where, size_if_missing));
        if (!first) continue;
        KINO_ASSIGN(auto second, read_camera(root, pair[1], where, size_if_missing));
        if (!second) return fail("the first camera is there and the second is not", where);
        out.cameras = {std::move(*first), std::move(*second)};
        const YamlNode* r = root.find("R");
        const YamlNode* t = root.find("T");
        if (r && t) {
            KINO_ASSIGN(out.second_from_first, read_pose(*r, *t, where));
        }
        return out;
    }
    KINO_ASSIGN(auto camera,
                read_camera(root,
                            {"camera",
                             {"camera_matrix", "cameraMatrix", "K"},
                             {"distortion_coefficients", "distortionCoefficients", "dist"},
                             {"img_size", "image_size"}},
                            where, size_if_missing));
    if (!camera) {
        return fail(
            "no camera is in this file", where,
            "camera_matrix, cameraMatrix, K, M1 and M2, or depth_intrinsics are looked for");
    }
    out.cameras = {std::move(*camera)};
    return out;
}

}  // namespace kino
