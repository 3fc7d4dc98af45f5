#include "calibration/registration_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/projection.h"
#include "tests/calibration/rig_samples.h"
#include "tests/reference/registration_reference.h"

namespace kino {
namespace {

using registration::find_rays;
using registration::RayTable;

struct Rays {
    std::vector<float> x, y, z;
    explicit Rays(std::size_t n) : x(n), y(n), z(n) {}
};

Rays whole_table(const RayTable& table, std::size_t n) {
    Rays out(n);
    table.read(0, n, out.x.data(), out.y.data(), out.z.data());
    return out;
}

struct TableError {
    double worst_px = 0;
    double rms_px = 0;
    int lost = 0;    // no ray where the reference has one
    int folded = 0;  // a ray where the reference has none
};

TableError table_error(const CameraModel& camera, const Image<glm::dvec2>& exact, int step) {
    const RayTable table(find_rays(camera, step), glm::dmat3(1));
    const Rays rays = whole_table(table, exact.size());
    TableError out;
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const bool has = !std::isnan(rays.x[i]);
        const bool should = !std::isnan(exact.pixels()[i].x);
        out.lost += should && !has;
        out.folded += has && !should;
        if (!has || !should) continue;
        const glm::dvec2 error(rays.x[i] - exact.pixels()[i].x, rays.y[i] - exact.pixels()[i].y);
        const double px = glm::length(error * glm::dvec2(camera.fx, camera.fy));
        out.worst_px = std::max(out.worst_px, px);
        squares += px * px;
        ++count;
    }
    out.rms_px = std::sqrt(squares / std::max(count, 1));
    return out;
}

TEST(RayTable, EveryDensityAgainstTheDoubleReference) {
    RigSamples samples(31);
    for (int i = 0; i < 6; ++i) {
        const CameraModel camera = samples.camera(123, 91);
        const Image<glm::dvec2> exact = reference::rays(camera);
        for (const int step : {1, 2, 4, 8}) {
            const TableError error = table_error(camera, exact, step);
            // The bound holds in the middle of four nodes and, the error being a parabola, nearly
            // so beside it; floats alone give 1e-3 px over a 1000 px focal length.
            const double bound = step == 1 ? 1e-4 : 1.5 * registration::RayNodes::kWorstTablePx;
            EXPECT_LT(error.worst_px, bound) << i << " step " << step;
            EXPECT_EQ(error.folded, 0) << i << " step " << step;
            // On the rim itself both may decide otherwise.
            EXPECT_LE(error.lost, 20) << i << " step " << step;
        }
    }
}

TEST(RayTable, SparserIsLessExact) {
    CameraModel camera = RigSamples(32).plain_camera(160, 120);
    camera.k1 = 0.2;
    const Image<glm::dvec2> exact = reference::rays(camera);
    const double two = table_error(camera, exact, 2).rms_px;
    const double four = table_error(camera, exact, 4).rms_px;
    EXPECT_GT(two, 0);
    // The error of linear interpolation grows with the square of the distance.
    EXPECT_NEAR(four / two, 4, 1);
}

TEST(RayTable, FoldingLensKeepsOwnRaysAtItsRim) {
    const CameraModel camera = RigSamples::folding_camera(160, 120);
    const TableError error = table_error(camera, reference::rays(camera), 8);
    EXPECT_EQ(error.folded, 0);
    EXPECT_LE(error.lost, 20);
    // The ray turns ever faster towards the rim, where no interpolation follows it.
    EXPECT_LT(error.worst_px, 0.2);
    EXPECT_FALSE(find_rays(camera, 8).exact.empty());
    EXPECT_TRUE(find_rays(RigSamples(1).plain_camera(160, 120), 8).exact.empty());
}

TEST(RayTable, AnyPartReadsLikeTheWhole) {
    RigSamples samples(33);
    const glm::dmat3 turn =
        glm::mat3_cast(glm::angleAxis(0.1, glm::normalize(glm::dvec3(1, 2, 3))));
    for (const auto& [width, height] : {std::pair(53, 37), std::pair(8, 9), std::pair(1, 5),
                                        std::pair(7, 1), std::pair(17, 16)}) {
        const auto n = static_cast<std::size_t>(width * height);
        for (const int step : {1, 2, 4, 8}) {
            const CameraModel camera = RigSamples::folding_camera(width, height);
            const RayTable table(find_rays(camera, step), turn);
            EXPECT_EQ(table.whole(0) != nullptr, step == 1);
            const Rays whole = whole_table(table, n);
            for (int k = 0; k < 50; ++k) {
                const auto first =
                    static_cast<std::size_t>(samples.uniform(0, 0.999) * static_cast<double>(n));
                const auto count = static_cast<std::size_t>(samples.uniform(0, 1) *
                                                            static_cast<double>(n - first));
                Rays part(count);
                table.read(first, count, part.x.data(), part.y.data(), part.z.data());
                for (std::size_t i = 0; i < count; ++i) {
                    if (std::isnan(part.x[i]) && std::isnan(whole.x[first + i])) continue;
                    ASSERT_EQ(part.x[i], whole.x[first + i]);
                    ASSERT_EQ(part.y[i], whole.y[first + i]);
                    ASSERT_EQ(part.z[i], whole.z[first + i]);
                }
            }
        }
    }
}

TEST(RayTable, SparserIsSmaller) {
    const CameraModel camera = RigSamples(34).plain_camera(320, 240);
    const auto bytes = [&](int step) {
        return RayTable(find_rays(camera, step), glm::dmat3(1)).bytes();
    };
    EXPECT_EQ(bytes(1), 320u * 240u * 12u);
    EXPECT_EQ(bytes(8), 41u * 31u * 12u);
}

}  // namespace
}  // namespace kino
