#include "apps/viewer/ply.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

namespace kino {
namespace {

constexpr std::size_t kPointBytes = 15;

void append_float(std::string& out, double value) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(bits >> shift));
}

}  // namespace

Result<std::int64_t> write_ply(const std::filesystem::path& path, const DepthSurface& surface,
                               const Pose& world_from_depth) {
    std::string points;
    std::int64_t count = 0;
    points.reserve(surface.depth_m.size() * kPointBytes);
    for (int y = 0; y < surface.depth_m.height(); ++y) {
        for (int x = 0; x < surface.depth_m.width(); ++x) {
            const double z = surface.depth_m.at(x, y);
            const RayXy ray = surface.rays->at(x, y);
            if (!(z > 0) || !std::isfinite(ray.x) || !std::isfinite(ray.y)) continue;
            const glm::dvec3 world = world_from_depth * glm::dvec3(ray.x * z, ray.y * z, z);
            for (int axis = 0; axis < 3; ++axis) append_float(points, world[axis]);
            Rgba8 color{150, 150, 150, 0};
            if (!surface.color.empty() && surface.color.at(x, y).a != 0)
                color = surface.color.at(x, y);
            for (const std::uint8_t channel : {color.r, color.g, color.b}) {
                points.push_back(static_cast<char>(channel));
            }
            ++count;
        }
    }
    std::ofstream file(path, std::ios::binary);
    file << fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment metres, y up\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
        count);
    file.write(points.data(), static_cast<std::streamsize>(points.size()));
    file.close();
    if (!file) return fail("could not be written", path.string());
    return count;
}

}  // namespace kino
