#include "apps/viewer/ply.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::TempDir;

struct PlyPoint {
    float x, y, z;
    Rgba8 color;
};

/// Reads what the header promises, as any reader of PLY would; the whole file must be used up.
std::vector<PlyPoint> read_ply(const std::filesystem::path& path) {
    const std::string bytes = test::read_bytes(path);
    const std::string end = "end_header\n";
    const std::size_t body = bytes.find(end) + end.size();
    std::istringstream header(bytes.substr(0, body));
    std::string line, properties;
    std::size_t count = 0;
    std::getline(header, line);
    EXPECT_EQ(line, "ply");
    std::getline(header, line);
    EXPECT_EQ(line, "format binary_little_endian 1.0");
    while (std::getline(header, line)) {
        if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
        if (line.starts_with("property ")) properties += line.substr(9) + ";";
    }
    EXPECT_EQ(properties, "float x;float y;float z;uchar red;uchar green;uchar blue;");
    EXPECT_EQ(bytes.size() - body, count * 15);
    std::vector<PlyPoint> points;
    const auto* at = reinterpret_cast<const unsigned char*>(bytes.data()) + body;
    const auto number = [&] {
        const std::uint32_t bits = at[0] | at[1] << 8 | at[2] << 16 | std::uint32_t{at[3]} << 24;
        at += 4;
        return std::bit_cast<float>(bits);
    };
    for (std::size_t i = 0; i < count; ++i) {
        PlyPoint point{};
        point.x = number();
        point.y = number();
        point.z = number();
        point.color = {at[0], at[1], at[2], 255};
        at += 3;
        points.push_back(point);
    }
    return points;
}

DepthSurface small_surface() {
    DepthSurface surface;
    surface.depth_m = Image<float>(3, 2, 0.0f);
    surface.depth_m.at(1, 0) = 2;
    surface.depth_m.at(2, 1) = 4;
    surface.depth_m.at(0, 1) = 1;  // its ray has no direction
    Image<RayXy> rays(3, 2);
    rays.at(1, 0) = {0.25f, -0.5f};
    rays.at(2, 1) = {0.5f, 0.125f};
    rays.at(0, 1) = {std::numeric_limits<float>::quiet_NaN(), 0};
    surface.rays = std::make_shared<Image<RayXy>>(rays);
    surface.color = Image<Rgba8>(3, 2, Rgba8{0, 0, 0, 0});
    surface.color.at(1, 0) = {10, 20, 30, 255};
    return surface;
}

TEST(Ply, PointsWithReadingsInWorldCoordinates) {
    const TempDir temp;
    const auto written = write_ply(temp / "points.ply", small_surface(), world_from_camera_axes());
    ASSERT_TRUE(written);
    EXPECT_EQ(*written, 2);
    const std::vector<PlyPoint> points = read_ply(temp / "points.ply");
    ASSERT_EQ(points.size(), 2u);
    // The world's y points up and its z towards the viewer.
    EXPECT_FLOAT_EQ(points[0].x, 0.5f);
    EXPECT_FLOAT_EQ(points[0].y, 1.0f);
    EXPECT_FLOAT_EQ(points[0].z, -2.0f);
    EXPECT_EQ(points[0].color, (Rgba8{10, 20, 30, 255}));
    EXPECT_FLOAT_EQ(points[1].x, 2.0f);
    EXPECT_FLOAT_EQ(points[1].y, -0.5f);
    EXPECT_FLOAT_EQ(points[1].z, -4.0f);
    EXPECT_EQ(points[1].color, (Rgba8{150, 150, 150, 255}));
}

TEST(Ply, WithoutColour) {
    const TempDir temp;
    DepthSurface surface = small_surface();
    surface.color = {};
    ASSERT_TRUE(write_ply(temp / "grey.ply", surface, {}));
    EXPECT_EQ(read_ply(temp / "grey.ply").size(), 2u);
}

TEST(Ply, AnUnwritablePlaceIsAnError) {
    const TempDir temp;
    EXPECT_FALSE(write_ply(temp / "no/such/folder.ply", small_surface(), {}));
}

}  // namespace
}  // namespace kino
