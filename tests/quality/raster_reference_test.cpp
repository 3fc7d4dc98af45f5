#include "tests/reference/raster_reference.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "tests/reference/depth_mesh_reference.h"
#include "tests/support/random.h"

namespace kino::reference {
namespace {

using test::Random;
using Points = std::vector<RasterPoint>;
using Triangles = std::vector<RasterTriangle>;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// At z = 1 a camera-space (x, y) is framebuffer (x, y): f = 1 px, principal point at (-0.5, -0.5).
RasterCamera plain_camera(int width = kWidth, int height = kHeight, double near_m = 0.5) {
    return pinhole_raster_camera(width, height, 1, 1, -0.5, -0.5, near_m);
}

RasterCamera kinect_camera() {
    return pinhole_raster_camera(kWidth, kHeight, 57, 57, 31.5, 23.5, 0.05);
}

RasterPoint flat(double x, double y, double z = 1, Rgba8 color = {}) {
    return {.position = {x * z, y * z, z}, .color = color};
}

int covered(const Image<RasterSample>& image) {
    int count = 0;
    for (const RasterSample& sample : image.pixels()) count += sample.covered() ? 1 : 0;
    return count;
}

TEST(RasterTriangles, AnalyticCoverageOfARightTriangle) {
    // Legs of 10 px on pixel borders: centres with (x + 0.5) + (y + 0.5) < 10, and the diagonal
    // itself is neither a top nor a left edge.
    const Points points{flat(0, 0), flat(10, 0), flat(0, 10)};
    const auto image = raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}});
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            EXPECT_EQ(image.at(x, y).covered(), x + y + 1 < 10) << x << ", " << y;
        }
    }
    EXPECT_EQ(covered(image), 45);
}

TEST(RasterTriangles, BothFacesAreDrawn) {
    const Points points{flat(1, 1), flat(20, 3), flat(4, 30)};
    const auto front = raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}});
    const auto back = raster_triangles(plain_camera(), points, Triangles{{0, 2, 1}});
    EXPECT_GT(covered(front), 100);
    for (std::size_t i = 0; i < front.size(); ++i) {
        EXPECT_EQ(front.pixels()[i].covered(), back.pixels()[i].covered());
    }
}

TEST(RasterTriangles, TopLeftRuleOnPixelCentres) {
    // A square with its borders exactly on centres owns its top and left ones only.
    const Points points{flat(2.5, 3.5), flat(7.5, 3.5), flat(2.5, 9.5), flat(7.5, 9.5)};
    const auto image = raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}, {1, 3, 2}});
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            EXPECT_EQ(image.at(x, y).covered(), x >= 2 && x < 7 && y >= 3 && y < 9);
        }
    }
}

/// A jittered grid mesh that covers [0, side] x [0, side] at z = 1, cells split either way.
struct GridMesh {
    Points points;
    Triangles triangles;
};
GridMesh jittered_mesh(int cells, double side, std::uint64_t seed, double snap) {
    Random random(seed);
    GridMesh mesh;
    const double step = side / cells;
    for (int y = 0; y <= cells; ++y) {
        for (int x = 0; x <= cells; ++x) {
            const auto moved = [&](int i) {
                const double jitter = i == 0 || i == cells ? 0 : random.real(-0.3, 0.3) * step;
                const double at = i * step + jitter;
                return snap > 0 ? std::round(at / snap) * snap : at;
            };
            const double px = moved(x);
            mesh.points.push_back(flat(px, moved(y)));
        }
    }
    const auto width = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t y = 0; y + 1 < width; ++y) {
        for (std::uint32_t x = 0; x + 1 < width; ++x) {
            const std::uint32_t a = y * width + x;
            const std::uint32_t b = a + 1;
            const std::uint32_t c = a + width;
            const std::uint32_t d = c + 1;
            if (random.chance(0.5)) {
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {d, c, b}});
            } else {
                mesh.triangles.insert(mesh.triangles.end(), {{a, d, c}, {d, a, b}});
            }
        }
    }
    return mesh;
}

TEST(RasterTriangles, MeshesCoverEachPixelExactlyOnce) {
    // Snapped to half pixels, nearly every edge runs through centres: the rule's hard case.
    for (const double snap : {0.0, 0.5}) {
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            const GridMesh mesh = jittered_mesh(9, 40, seed, snap);
            Image<int> hits(kWidth, kHeight, 0);
            for (const RasterTriangle& triangle : mesh.triangles) {
                const auto one = raster_triangles(plain_camera(), mesh.points, {&triangle, 1});
                for (std::size_t i = 0; i < hits.size(); ++i) {
                    hits.pixels()[i] += one.pixels()[i].covered() ? 1 : 0;
                }
            }
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    ASSERT_EQ(hits.at(x, y), x < 40 && y < 40 ? 1 : 0)
                        << "seed " << seed << " snap " << snap << " at " << x << ", " << y;
                }
            }
        }
    }
}

/// Depth along the pixel's ray to the plane through three points; NaN if parallel.
double ray_plane_depth(const RasterCamera& camera, const std::array<glm::dvec3, 3>& p, int x,
                       int y) {
    const glm::dvec3 ray{(x - 31.5) / 57, (y - 23.5) / 57, 1};
    EXPECT_EQ(camera.width, kWidth);
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    return glm::dot(normal, p[0]) / glm::dot(normal, ray);
}

TEST(RasterTriangles, PerspectiveCorrectAgainstRayPlaneIntersection) {
    Random random(11);
    int compared = 0;
    for (int round = 0; round < 60; ++round) {
        Points points;
        std::array<glm::dvec3, 3> p;
        for (auto& corner : p) {
            const double z = random.real(0.4, 6);
            corner = {random.real(-0.5, 0.5) * z, random.real(-0.4, 0.4) * z, z};
            points.push_back({.position = corner,
                              .color = {static_cast<std::uint8_t>(random.integer(0, 255)), 0, 0}});
        }
        const auto image = raster_triangles(kinect_camera(), points, Triangles{{0, 1, 2}});
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const RasterSample& sample = image.at(x, y);
                if (!sample.covered()) continue;
                ++compared;
                const double expected = ray_plane_depth(kinect_camera(), p, x, y);
                ASSERT_NEAR(sample.depth_m, expected, 1e-9);
                // The weights must rebuild the point on the ray, and the colour follow them.
                const auto& b = sample.barycentric;
                const glm::dvec3 at = b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
                ASSERT_NEAR(at.x, (x - 31.5) / 57 * expected, 1e-9);
                ASSERT_NEAR(at.y, (y - 23.5) / 57 * expected, 1e-9);
                ASSERT_NEAR(b[0] + b[1] + b[2], 1, 1e-12);
                ASSERT_GE(std::min({b[0], b[1], b[2]}), -1e-9);
                const double red =
                    b[0] * points[0].color.r + b[1] * points[1].color.r + b[2] * points[2].color.r;
                ASSERT_LE(std::abs(sample.color.r - red), 0.5 + 1e-9);
            }
        }
    }
    EXPECT_GT(compared, 5000);
}

TEST(RasterTriangles, NearPlaneClippingAgainstAnAnalyticFloor) {
    // A floor 1 m below runs from 5 m behind the camera to 60 m ahead. A pixel sees it at depth
    // 1 / ray.y, and only where that is beyond the near plane.
    const double near_m = 3.0;
    const auto camera = pinhole_raster_camera(kWidth, kHeight, 57, 57, 31.5, 23.5, near_m);
    Points points;
    for (const double x : {-200.0, 200.0}) {
        for (const double z : {-5.0, 60.0}) points.push_back({.position = {x, 1, z}, .color = {}});
    }
    const auto image = raster_triangles(camera, points, Triangles{{0, 1, 2}, {1, 3, 2}});
    int seen = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const double ray_y = (y - 23.5) / 57;
            const double depth = 1 / ray_y;
            const bool expected = ray_y > 0 && depth > near_m && depth < 60;
            ASSERT_EQ(image.at(x, y).covered(), expected) << x << ", " << y;
            if (!expected) continue;
            ++seen;
            ASSERT_NEAR(image.at(x, y).depth_m, depth, 1e-9);
        }
    }
    EXPECT_GT(seen, 1000);
    EXPECT_FALSE(image.at(32, kHeight - 1).covered());  // nearer than the near plane
}

TEST(RasterTriangles, NearPlaneClippingKeepsMeshesWhole) {
    // The camera stands in a closed room of eight corners: each pixel sees exactly one wall.
    const auto camera = pinhole_raster_camera(kWidth, kHeight, 20, 20, 31.5, 23.5, 0.01);
    Points points;
    for (int i = 0; i < 8; ++i) {
        points.push_back({.position = {(i & 1) != 0 ? 1.3 : -1.1, (i & 2) != 0 ? 1.2 : -0.9,
                                       (i & 4) != 0 ? 2.1 : -1.7},
                          .color = {}});
    }
    Triangles walls;
    for (const std::array<std::uint32_t, 4>& quad : {std::array<std::uint32_t, 4>{0, 1, 2, 3},
                                                     {4, 5, 6, 7},
                                                     {0, 1, 4, 5},
                                                     {2, 3, 6, 7},
                                                     {0, 2, 4, 6},
                                                     {1, 3, 5, 7}}) {
        walls.push_back({quad[0], quad[1], quad[2]});
        walls.push_back({quad[1], quad[3], quad[2]});
    }
    Image<int> hits(kWidth, kHeight, 0);
    for (const RasterTriangle& wall : walls) {
        const auto one = raster_triangles(camera, points, {&wall, 1});
        for (std::size_t i = 0; i < hits.size(); ++i) {
            hits.pixels()[i] += one.pixels()[i].covered() ? 1 : 0;
        }
    }
    for (const int hit : hits.pixels()) ASSERT_EQ(hit, 1);
}

TEST(RasterTriangles, BehindTheCameraIsNothing) {
    const Points points{flat(1, 1, -1), flat(20, 3, -2), flat(4, 30, -3)};
    EXPECT_EQ(covered(raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}})), 0);
}

TEST(RasterTriangles, DegenerateOnesAreNothing) {
    const Points points{flat(1, 1), flat(20, 20), flat(10, 10), flat(1, 1)};
    EXPECT_EQ(covered(raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}, {0, 3, 1}})),
              0);
}

TEST(RasterTriangles, NearestWinsWhateverTheOrderAndTiesGoToTheFirst) {
    Points points;
    for (const double z : {2.0, 1.0, 1.0}) {
        points.insert(points.end(), {flat(0, 0, z), flat(30, 0, z), flat(0, 30, z)});
    }
    const Triangles far_first{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    const Triangles far_last{{3, 4, 5}, {6, 7, 8}, {0, 1, 2}};
    EXPECT_EQ(raster_triangles(plain_camera(), points, far_first).at(5, 5).id, 1u);
    EXPECT_EQ(raster_triangles(plain_camera(), points, far_last).at(5, 5).id, 0u);
    EXPECT_NEAR(raster_triangles(plain_camera(), points, far_first).at(5, 5).depth_m, 1, 1e-12);
}

TEST(RasterTriangles, IndependentOfWhereTheViewMatrixIsApplied) {
    // World points through a view in the matrix, or camera points: the same picture.
    const double angle = 0.4;
    glm::dmat4 camera_from_world(1.0);
    camera_from_world[0] = {std::cos(angle), 0, -std::sin(angle), 0};
    camera_from_world[2] = {std::sin(angle), 0, std::cos(angle), 0};
    camera_from_world[3] = {0.2, -0.1, 0.5, 1};
    RasterCamera world_camera = kinect_camera();
    world_camera.clip_from_point = world_camera.clip_from_point * camera_from_world;
    const auto row = [&](int c) { return camera_from_world[c][2]; };
    world_camera.view_depth_row = {row(0), row(1), row(2), row(3)};

    Random random(5);
    Points world;
    Points camera;
    Triangles triangles;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const glm::dvec3 p{random.real(-1, 1), random.real(-1, 1), random.real(0, 4)};
        world.push_back({.position = p, .color = {}});
        camera.push_back(
            {.position = glm::dvec3(camera_from_world * glm::dvec4(p, 1)), .color = {}});
        if (i % 3 == 2) triangles.push_back({i - 2, i - 1, i});
    }
    const auto a = raster_triangles(world_camera, world, triangles);
    const auto b = raster_triangles(kinect_camera(), camera, triangles);
    int seen = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a.pixels()[i].id, b.pixels()[i].id);
        if (!a.pixels()[i].covered()) continue;
        ++seen;
        ASSERT_NEAR(a.pixels()[i].depth_m, b.pixels()[i].depth_m, 1e-9);
    }
    EXPECT_GT(seen, 500);
}

TEST(RasterPoints, FallIntoTheirOwnPixel) {
    // From the sensor's own view each depth pixel comes back at its place: pixel centres.
    Random random(8);
    Image<float> depth(kWidth, kHeight);
    for (float& z : depth.pixels()) z = static_cast<float>(random.real(0.5, 5));
    const auto points = depth_grid_points(depth, 57, 57, 31.5, 23.5);
    const auto image = raster_points(kinect_camera(), points);
    for (std::size_t i = 0; i < image.size(); ++i) {
        ASSERT_EQ(image.pixels()[i].id, i);
        ASSERT_NEAR(image.pixels()[i].depth_m, static_cast<double>(depth.pixels()[i]), 1e-12);
    }
}

TEST(RasterPoints, LeftAndTopBordersBelongToThePixel) {
    // Sides of a power of two, so that borders are hit exactly.
    const Points points{flat(4.0, 7.0), flat(9.0 - 1e-9, 7.0), flat(-1e-9, 3), flat(64, 3)};
    const auto image = raster_points(plain_camera(64, 64), points);
    EXPECT_EQ(image.at(4, 7).id, 0u);
    EXPECT_EQ(image.at(8, 7).id, 1u);
    EXPECT_EQ(covered(image), 2);
}

TEST(RasterPoints, NearPlaneIsInclusiveAndNothingBeforeIt) {
    const Points points{flat(4.5, 7.5, 0.5), flat(6.5, 7.5, std::nextafter(0.5, 0)),
                        flat(8.5, 7.5, 0), flat(9.5, 7.5, -1)};
    const auto image = raster_points(plain_camera(), points);
    EXPECT_EQ(image.at(4, 7).id, 0u);
    EXPECT_EQ(covered(image), 1);
}

TEST(RasterPoints, NotANumberIsNothing) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Points points{{.position = {nan, 1, 1}, .color = {}},
                        {.position = {1, 1, nan}, .color = {}}};
    EXPECT_EQ(covered(raster_points(plain_camera(), points)), 0);
    EXPECT_EQ(covered(raster_squares(plain_camera(), points, [](double) { return 2.0; })), 0);
}

TEST(RasterSquares, SideFollowsDepthAndNearestWins) {
    const Points points{flat(10.5, 10.5, 2, {9, 0, 0, 255}), flat(11.5, 10.5, 1, {7, 0, 0, 255})};
    const auto image =
        raster_squares(plain_camera(), points, [](double z) { return z == 1 ? 1.5 : 2.5; });
    // 3x3 in front of 5x5: the near square takes nine pixels, of which all lie in the far one.
    int near_pixels = 0;
    for (const RasterSample& sample : image.pixels()) near_pixels += sample.id == 1 ? 1 : 0;
    EXPECT_EQ(near_pixels, 9);
    EXPECT_EQ(covered(image), 25);
    EXPECT_EQ(image.at(8, 8).color.r, 9);
    EXPECT_EQ(image.at(10, 10).color.r, 7);
}

TEST(RasterSquares, HalfAPixelIsOnePixelLikeRasterPoints) {
    Random random(21);
    Points points;
    for (int i = 0; i < 300; ++i) {
        points.push_back(
            flat(random.real(-2, kWidth + 2), random.real(-2, kHeight + 2), random.real(0.6, 5)));
    }
    const auto squares = raster_squares(plain_camera(), points, [](double) { return 0.5; });
    const auto dots = raster_points(plain_camera(), points);
    int different = 0;
    for (std::size_t i = 0; i < dots.size(); ++i) {
        different += squares.pixels()[i].id == dots.pixels()[i].id ? 0 : 1;
    }
    EXPECT_EQ(different, 0);
    EXPECT_GT(covered(dots), 200);
}

TEST(RasterSquares, CutByThePicturesBorder) {
    const auto image =
        raster_squares(plain_camera(), Points{flat(-1, -1)}, [](double) { return 3.0; });
    EXPECT_EQ(covered(image), 4);
    EXPECT_TRUE(image.at(1, 1).covered());
}

TEST(Nearer, MergesPointsAndTrianglesWithIdsApart) {
    const Points points{flat(0, 0, 2), flat(40, 0, 2), flat(0, 40, 2), flat(3.5, 3.5, 1),
                        flat(4.5, 3.5, 3)};
    const auto mesh = raster_triangles(plain_camera(), points, Triangles{{0, 1, 2}});
    const auto dots = raster_points(plain_camera(), points);
    const auto both = nearer(mesh, dots, 100);
    EXPECT_EQ(both.at(3, 3).id, 103u);
    EXPECT_EQ(both.at(4, 3).id, 0u);
    EXPECT_EQ(both.at(60, 40).id, RasterSample::kNothing);
}

}  // namespace
}  // namespace kino::reference
