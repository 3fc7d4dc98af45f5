#include "tests/reference/depth_mesh_reference.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/support/random.h"

namespace kino::reference {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr EdgeTest kFixed{.kind = EdgeTest::Kind::fixed};

Image<float> grid(int width, int height, std::initializer_list<float> depths) {
    Image<float> image(width, height);
    std::copy(depths.begin(), depths.end(), image.data());
    return image;
}

TEST(EdgeTest, RangeAwareThresholdInNumbers) {
    // tan(80 deg) = 5.671282: 3 * 3.07 mm + 5671.282 mm / 571.26, and so on.
    const EdgeTest full{.focal_px = 571.26};
    EXPECT_NEAR(full.threshold_m(1), 0.0191376, 1e-6);
    EXPECT_NEAR(full.threshold_m(4), 0.1870706, 1e-6);
    // The same field of view in 320x240 has neighbours twice as far apart: 29 mm and 227 mm.
    const EdgeTest half{.focal_px = 285.63};
    EXPECT_NEAR(half.threshold_m(1), 0.029, 0.0005);
    EXPECT_NEAR(half.threshold_m(4), 0.227, 0.0005);
}

TEST(EdgeTest, FixedThresholdIgnoresRange) {
    EXPECT_EQ(kFixed.threshold_m(0.5), 0.075);
    EXPECT_EQ(kFixed.threshold_m(8), 0.075);
}

TEST(DepthGridTriangles, OneCellIsSplitFromUpperRightToLowerLeft) {
    EXPECT_THAT(depth_grid_triangles(Image<float>(2, 2, 1.0f), kFixed),
                ElementsAre(RasterTriangle{0, 1, 2}, RasterTriangle{1, 3, 2}));
}

TEST(DepthGridTriangles, AFlatWallKeepsAll) {
    const auto triangles = depth_grid_triangles(Image<float>(7, 5, 2.0f), {});
    EXPECT_EQ(triangles.size(), 2u * 6 * 4);
}

TEST(DepthGridTriangles, AcrossAValidityEdge) {
    // One hole in the middle of 3x3 takes the six triangles around it and leaves two corners.
    Image<float> depth(3, 3, 1.5f);
    for (const float hole : {0.0f, 0.1f, -1.0f, std::numeric_limits<float>::quiet_NaN(),
                             std::numeric_limits<float>::infinity()}) {
        depth.at(1, 1) = hole;
        EXPECT_THAT(depth_grid_triangles(depth, kFixed),
                    ElementsAre(RasterTriangle{0, 1, 3}, RasterTriangle{5, 8, 7}))
            << hole;
        EXPECT_THAT(depth_grid_triangles(Image<float>(2, 2, hole), kFixed), IsEmpty()) << hole;
    }
}

TEST(DepthGridTriangles, JustValidIsKept) {
    const float just = std::nextafter(0.1f, 1.0f);
    EXPECT_EQ(depth_grid_triangles(Image<float>(2, 2, just), kFixed).size(), 2u);
}

TEST(DepthGridTriangles, EachOfTheThreeEdgesTears) {
    // Second triangle of the cell: corners 10, 11, 01. Each lone far corner tears it.
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {1, 1.0f, 1, 1.5f}), kFixed),
                ElementsAre(RasterTriangle{0, 1, 2}));
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {1.5f, 1, 1, 1}), kFixed),
                ElementsAre(RasterTriangle{1, 3, 2}));
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {1, 1.5f, 1, 1}), kFixed), IsEmpty());
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {1, 1, 1.5f, 1}), kFixed), IsEmpty());
}

TEST(DepthGridTriangles, ThresholdIsExclusiveAndTakesTheNearestDepth) {
    const EdgeTest test{.kind = EdgeTest::Kind::fixed, .fixed_m = 0.25};
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {1, 1.25f, 1, 1}), test), IsEmpty());
    EXPECT_EQ(depth_grid_triangles(grid(2, 2, {1, 1.2f, 1, 1}), test).size(), 2u);
    // T(4.0) = 187.07 mm, T(4.187) = 203 mm: a step of 190 mm up from 4 m is torn.
    EXPECT_THAT(depth_grid_triangles(grid(2, 2, {4, 4.19f, 4, 4}), {}), IsEmpty());
    EXPECT_EQ(depth_grid_triangles(grid(2, 2, {4, 4.186f, 4, 4}), {}).size(), 2u);
}

TEST(DepthGridTriangles, MirroredSplitHasTheSameCountOnSymmetricDepth) {
    // Transposing the grid maps the split onto itself, so the count must not change.
    test::Random random(4);
    Image<float> depth(17, 17);
    Image<float> transposed(17, 17);
    for (int y = 0; y < 17; ++y) {
        for (int x = 0; x < 17; ++x) {
            depth.at(x, y) = random.chance(0.1) ? 0 : static_cast<float>(random.real(1, 1.1));
            transposed.at(y, x) = depth.at(x, y);
        }
    }
    const auto count = depth_grid_triangles(depth, kFixed).size();
    EXPECT_GT(count, 100u);
    EXPECT_LT(count, 512u);
    EXPECT_EQ(count, depth_grid_triangles(transposed, kFixed).size());
}

TEST(DepthGridTriangles, DegenerateGridsHaveNone) {
    EXPECT_THAT(depth_grid_triangles({}, {}), IsEmpty());
    EXPECT_THAT(depth_grid_triangles(Image<float>(1, 9, 1.0f), {}), IsEmpty());
    EXPECT_THAT(depth_grid_triangles(Image<float>(9, 1, 1.0f), {}), IsEmpty());
}

TEST(DepthGridPoints, LieOnTheirPixelsRays) {
    Image<float> depth(4, 3, 2.0f);
    depth.at(1, 1) = 0;
    const auto points = depth_grid_points(depth, 10, 20, 1.5, 1.0);
    EXPECT_EQ(points[0].position, glm::dvec3(-0.3, -0.1, 2));
    EXPECT_EQ(points[11].position, glm::dvec3(0.3, 0.1, 2));
    EXPECT_EQ(points[5].position, glm::dvec3(0, 0, 0));
}

}  // namespace
}  // namespace kino::reference
