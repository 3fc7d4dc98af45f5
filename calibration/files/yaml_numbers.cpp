#include "calibration/files/yaml_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensor/decimal.h"

namespace kino {
namespace {

std::string at_line(const YamlNode& node, const std::string& where) {
    return fmt::format("{}, line {}", where, node.line);
}

}  // namespace

Result<int> whole_number(const YamlNode& node, int least, int most, const std::string& where) {
    const auto value = parse_number(node.scalar);
    if (!value || *value != std::floor(*value) || *value < least || *value > most) {
        return fail(fmt::format("no whole number from {} to {}", least, most),
                    at_line(node, where));
    }
    return static_cast<int>(*value);
}

Result<std::vector<double>> matrix_numbers(const YamlNode& node, const std::string& where) {
    const YamlNode* rows = node.find("rows");
    const YamlNode* columns = node.find("cols");
    const YamlNode* data = node.find("data");
    if (!rows || !columns || !data || !data->is_list) {
        return fail("no matrix of rows, cols and data", at_line(node, where));
    }
    KINO_ASSIGN(const int row_count, whole_number(*rows, 0, 64, where));
    KINO_ASSIGN(const int column_count, whole_number(*columns, 0, 64, where));
    std::vector<double> out;
    for (const std::string& item : data->list) {
        const auto value = parse_number(item);
        if (!value) return fail(fmt::format("\"{}\" is no number", item), at_line(*data, where));
        out.push_back(*value);
    }
    if (out.size() != static_cast<std::size_t>(row_count * column_count)) {
        return fail(
            fmt::format("{} numbers in a matrix of {} x {}", out.size(), row_count, column_count),
            at_line(*data, where));
    }
    return out;
}

Result<void> set_matrix(CameraModel& camera, const std::vector<double>& m,
                        const std::string& where) {
    const bool pinhole =
        m.size() == 9 && m[1] == 0 && m[3] == 0 && m[6] == 0 && m[7] == 0 && m[8] == 1;
    if (!pinhole) return fail("the camera matrix is not fx 0 cx, 0 fy cy, 0 0 1", where);
    camera.fx = m[0];
    camera.fy = m[4];
    camera.cx = m[2];
    camera.cy = m[5];
    return {};
}

Result<void> set_distortion(CameraModel& camera, const std::vector<double>& d,
                            const std::string& where) {
    const bool whole = d.size() == 4 || d.size() == 5 || d.size() == 8 || d.size() == 12 ||
                       d.size() == 14 || d.empty();
    if (!whole ||
        std::any_of(d.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(8, d.size())),
                    d.end(), [](double v) { return v != 0; })) {
        return fail(fmt::format("distortion of {} numbers is not known here", d.size()), where,
                    "4, 5 or 8 numbers are; thin prisms and tilted sensors are not");
    }
    const auto number = [&](std::size_t i) { return i < d.size() ? d[i] : 0.0; };
    camera.k1 = number(0);
    camera.k2 = number(1);
    camera.p1 = number(2);
    camera.p2 = number(3);
    camera.k3 = number(4);
    camera.k4 = number(5);
    camera.k5 = number(6);
    camera.k6 = number(7);
    return {};
}

std::vector<double> distortion_numbers(const CameraModel& c) {
    if (c.k4 == 0 && c.k5 == 0 && c.k6 == 0) return {c.k1, c.k2, c.p1, c.p2, c.k3};
    return {c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6};
}

std::string joined_numbers(std::span<const double> numbers) {
    return fmt::format("{}", fmt::join(numbers, ", "));
}

}  // namespace kino
