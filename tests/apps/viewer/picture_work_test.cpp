#include "apps/viewer/picture_work.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "apps/viewer/surprises.h"
#include "tests/support/random.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

View looking_ahead() {
    return {.width = 320, .height = 180, .projection = perspective(0.8, 320, 180)};
}

/// Share of the picture's pixels whose rays meet the sphere, one by one.
double share_by_rays(const glm::dvec3& center, double radius, const View& view) {
    int met = 0;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const glm::dvec3 ray =
                glm::normalize(glm::dvec3((x - view.projection.cx) / view.projection.fx,
                                          (y - view.projection.cy) / view.projection.fy, 1));
            const double along = glm::dot(ray, center);
            const double off2 = glm::dot(center, center) - along * along;
            met += along + std::sqrt(std::max(0.0, radius * radius - off2)) > 0 &&
                           off2 <= radius * radius
                       ? 1
                       : 0;
        }
    }
    return met / (320.0 * 180);
}

TEST(PictureWork, LightsCountWithWhatTheyCanReach) {
    test::Random random(1);
    const View view = looking_ahead();
    const double none = count_work({}, view).lights;
    EXPECT_GT(none, 0);
    for (int round = 0; round < 200; ++round) {
        Scene scene;
        const glm::dvec3 center(random.real(-3, 3), random.real(-2, 2), random.real(-3, 8));
        const double radius = random.real(0.1, 2);
        scene.lights.push_back(
            {.kind = LightKind::point, .position = center, .radius_m = static_cast<float>(radius)});
        const double counted = count_work(scene, view).lights - none;
        const double seen = share_by_rays(center, radius, view);
        // A box about what is seen of it: more, but not much.
        EXPECT_GE(counted, seen - 1e-9) << center.x << ' ' << center.y << ' ' << center.z;
        if (center.z > 2 * radius) {
            EXPECT_LE(counted, 1.5 * seen + 0.03);
        }
    }
}

TEST(PictureWork, CountsTrianglesAndSurvivesNonsense) {
    Scene scene;
    const View view = looking_ahead();
    EXPECT_EQ(count_work(scene, view).triangles, 0);
    scene.meshes.push_back({.mesh = make_box({1, 1, 1})});
    scene.meshes.push_back({});
    EXPECT_EQ(count_work(scene, view).triangles, 12);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional}) {
        scene.lights.push_back({.kind = kind, .position = {nan, 0, 1}});
        scene.lights.push_back({.kind = kind, .direction = {0, 0, 0}, .outer_rad = 0.1f});
        scene.lights.push_back({.kind = kind, .radius_m = -1});
    }
    for (const View& bad : {view, View{}, View{.width = 10, .height = 10}}) {
        const PictureWork work = count_work(scene, bad);
        EXPECT_TRUE(std::isfinite(work.lights));
        EXPECT_GT(work.lights, 0);
    }
}

TEST(Surprises, AreRecentAndOfWhatWasPredicted) {
    Surprises surprises;
    EXPECT_GT(surprises.quantile(0.95), 1);
    for (int i = 0; i < 200; ++i) surprises.add(10, 20);
    EXPECT_EQ(surprises.quantile(0.5), 2);
    // 1 to 1.64 in steps of a hundredth are all that is remembered.
    for (int i = 1; i <= 64; ++i) surprises.add(10, 10 + 0.1 * i);
    EXPECT_NEAR(surprises.quantile(0), 1.01, 1e-9);
    EXPECT_NEAR(surprises.quantile(1), 1.64, 1e-9);
    EXPECT_NEAR(surprises.quantile(0.5), 1.32, 0.011);
    surprises.add(0, 5);
    surprises.add(10, std::numeric_limits<double>::quiet_NaN());
    surprises.add(-3, 5);
    EXPECT_NEAR(surprises.quantile(1), 1.64, 1e-9);
    surprises.forget();
    EXPECT_EQ(surprises.quantile(0.1), Surprises().quantile(0.9));
}

}  // namespace
}  // namespace kino
