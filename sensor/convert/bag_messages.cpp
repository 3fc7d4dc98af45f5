#include "sensor/convert/bag_messages.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "sensor/convert/bag_record.h"
#include "sensor/decimal.h"

namespace kino {
namespace {

constexpr std::uint32_t kMaxBagEdge = 16384;

struct RosHeader {
    std::uint32_t sequence = 0;
    TimeNs stamp = 0;
};

RosHeader read_header(BagCursor& cursor) {
    RosHeader header;
    header.sequence = cursor.u32();
    header.stamp = bag_time(cursor.number(8));
    (void)cursor.counted();
    return header;
}

bool is_size(std::uint32_t side) {
    return side >= 1 && side <= kMaxBagEdge;
}

}  // namespace

std::optional<RosImage> read_ros_image(std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    RosImage image;
    const RosHeader header = read_header(cursor);
    image.sequence = header.sequence;
    image.stamp = header.stamp;
    const std::uint32_t height = cursor.u32();
    const std::uint32_t width = cursor.u32();
    image.encoding = cursor.text();
    image.big_endian = cursor.u8() != 0;
    image.step = cursor.u32();
    image.data = cursor.counted();
    if (!cursor.good() || !is_size(width) || !is_size(height) || header.stamp < 0 ||
        image.step > image.data.size() / height) {
        return std::nullopt;
    }
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    return image;
}

std::optional<RosCamera> read_ros_camera(std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    (void)read_header(cursor);
    const std::uint32_t height = cursor.u32();
    const std::uint32_t width = cursor.u32();
    RosCamera out;
    out.model = cursor.text();
    const std::uint32_t count = cursor.u32();
    if (!cursor.good() || count > cursor.left() / 8) return std::nullopt;
    std::array<double, 5> d{};
    for (std::uint32_t i = 0; i < count; ++i) {
        const double value = cursor.f64();
        if (i < d.size()) d[i] = value;
    }
    std::array<double, 9> k{};
    for (double& value : k) value = cursor.f64();
    if (!cursor.good() || !is_size(width) || !is_size(height)) return std::nullopt;
    out.camera = {.width = static_cast<int>(width),
                  .height = static_cast<int>(height),
                  .fx = k[0],
                  .fy = k[4],
                  .cx = k[2],
                  .cy = k[5],
                  .k1 = d[0],
                  .k2 = d[1],
                  .k3 = d[4],
                  .p1 = d[2],
                  .p2 = d[3]};
    return out;
}

std::optional<Pose> read_ros_transform(std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    Pose pose;
    for (int axis = 0; axis < 3; ++axis) pose.translation[axis] = cursor.f64();
    const double x = cursor.f64();
    const double y = cursor.f64();
    const double z = cursor.f64();
    const double w = cursor.f64();
    pose.rotation = glm::dquat(w, x, y, z);
    const double length = glm::length(pose.rotation);
    // Written from floats; further from unit length is no rotation.
    if (!cursor.good() || !(std::abs(length - 1) < 1e-3)) return std::nullopt;
    pose.rotation = glm::normalize(pose.rotation);
    if (!is_valid(pose)) return std::nullopt;
    return pose;
}

std::optional<std::pair<std::string, std::string>> read_ros_key_value(
    std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    std::string key = cursor.text();
    std::string value = cursor.text();
    if (!cursor.good()) return std::nullopt;
    return std::pair(std::move(key), std::move(value));
}

std::optional<double> read_ros_float(std::span<const std::uint8_t> bytes) {
    BagCursor cursor(bytes);
    const float value = cursor.f32();
    if (!cursor.good() || !std::isfinite(value)) return std::nullopt;
    return parse_number(fmt::format("{}", value));
}

}  // namespace kino
