#include "apps/viewer/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "apps/viewer/depth_colors.h"
#include "apps/viewer/keys.h"
#include "apps/viewer/measure.h"
#include "tests/support/random.h"

namespace kino {
namespace {

ScenePlace somewhere() {
    ScenePlace place;
    place.world_from_depth = world_from_camera_axes();
    place.distance_m = 2.5;
    place.center = place.world_from_depth * glm::dvec3(0.3, -0.2, 2.48);
    return place;
}

double distance(const OrbitCamera& camera, const glm::dvec3& to) {
    return glm::distance(camera.pose().translation, to);
}

TEST(OrbitCamera, KeepsItsDistanceAndLooksAtTheCentre) {
    const ScenePlace place = somewhere();
    OrbitCamera camera;
    camera.reset(place);
    test::Random random(7);
    const double before = distance(camera, place.center);
    for (int i = 0; i < 200; ++i) {
        camera.turn(random.real(-1, 1), random.real(-1, 1));
        const Pose pose = camera.pose();
        EXPECT_NEAR(glm::distance(pose.translation, place.center), before, 1e-9);
        const glm::dvec3 seen = inverse(pose) * place.center;
        EXPECT_NEAR(seen.x, 0, 1e-9);
        EXPECT_NEAR(seen.y, 0, 1e-9);
        EXPECT_GT(seen.z, 0);
        // Up stays up in the picture: y down means the world's y turns negative.
        EXPECT_LT((inverse(pose).rotation * glm::dvec3(0, 1, 0)).y, 0);
    }
}

TEST(OrbitCamera, SwaysUntilTouchedAndDoesNotJumpThen) {
    OrbitCamera camera;
    camera.reset(somewhere());
    camera.set_time(1);
    const glm::dvec3 first = camera.pose().translation;
    camera.set_time(2.5);
    const glm::dvec3 second = camera.pose().translation;
    EXPECT_GT(glm::distance(first, second), 0.05);
    camera.turn(0, 0);
    EXPECT_LT(glm::distance(camera.pose().translation, second), 1e-12);
    camera.set_time(5);
    EXPECT_LT(glm::distance(camera.pose().translation, second), 1e-12);
}

TEST(OrbitCamera, PanningMovesTheCentreInThePicturePlane) {
    OrbitCamera camera;
    camera.reset(somewhere());
    camera.hold_still();
    const Pose before = camera.pose();
    camera.pan({0.1, 0.2});
    const glm::dvec3 moved =
        inverse(before).rotation * (camera.pose().translation - before.translation);
    EXPECT_GT(moved.x, 0);
    EXPECT_LT(moved.y, 0);
    EXPECT_NEAR(moved.z, 0, 1e-9);
}

TEST(FlyCamera, StartsWhereTheLastPictureWasSeenFrom) {
    CameraControl camera;
    camera.reset(somewhere());
    camera.orbit.turn(0.4, 0.2);
    const Pose seen_from = camera.orbit.pose();
    camera.choose(ViewKind::fly, seen_from);
    const Pose flying = camera.fly.pose();
    EXPECT_LT(glm::distance(flying.translation, seen_from.translation), 1e-9);
    const glm::dvec3 ahead(0, 0, 1);
    EXPECT_LT(glm::distance(flying.rotation * ahead, seen_from.rotation * ahead), 1e-9);
    camera.fly.move({0, 0, 1});
    EXPECT_LT(glm::distance(camera.fly.pose().translation,
                            seen_from.translation + seen_from.rotation * ahead),
              1e-9);
}

TEST(Measure, PointAtUndoesProjection) {
    CameraControl camera;
    camera.reset(somewhere());
    const CameraModel depth{
        .width = 640, .height = 480, .fx = 570, .fy = 570, .cx = 320, .cy = 240};
    test::Random random(11);
    for (const ViewKind kind : {ViewKind::sensor, ViewKind::orbit, ViewKind::fly}) {
        camera.kind = kind;
        const View view = camera.view(depth, world_from_camera_axes(), 1280, 720);
        for (int i = 0; i < 50; ++i) {
            const glm::dvec2 pixel(random.real(0, 1279), random.real(0, 719));
            const glm::dvec3 world = point_at(view, pixel, random.real(0.3, 9));
            const auto back = project_to_pixel(view, world);
            ASSERT_TRUE(back);
            EXPECT_NEAR(back->x, pixel.x, 1e-7);
            EXPECT_NEAR(back->y, pixel.y, 1e-7);
        }
    }
}

TEST(Measure, TwoPointsThenAnew) {
    Measure measure;
    EXPECT_FALSE(measure.distance_m());
    measure.add({0, 0, 0});
    EXPECT_FALSE(measure.distance_m());
    measure.add({3, 4, 12});
    EXPECT_DOUBLE_EQ(measure.distance_m().value_or(0), 13);
    measure.add({1, 1, 1});
    EXPECT_EQ(measure.points().size(), 1u);
}

TEST(DepthColors, LightnessFallsWithDepthAndNothingIsBlack) {
    const DepthRange range{0.5f, 4};
    const auto lightness = [&](float z) {
        const Rgba8 c = depth_color(z, range);
        return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    };
    for (float z = 0.5f; z < 3.9f; z += 0.1f) EXPECT_GT(lightness(z), lightness(z + 0.1f)) << z;
    EXPECT_EQ(depth_color(0, range), (Rgba8{0, 0, 0, 255}));
    EXPECT_EQ(depth_color(0.1f, range), depth_color(0.5f, range));
    EXPECT_EQ(depth_color(99, range), depth_color(4, range));
}

TEST(DepthColors, RangeIgnoresHolesAndStragglers) {
    Image<float> depth(200, 100, 0.0f);
    for (int y = 20; y < 100; ++y) {
        for (int x = 0; x < 200; ++x) depth.at(x, y) = 1 + static_cast<float>(x) / 100;
    }
    // A hundredth of all pixels far too far away.
    for (std::size_t i = 0; i < depth.size(); i += 101) depth.data()[i] = 90;
    const auto range = depth_range(depth);
    ASSERT_TRUE(range);
    EXPECT_NEAR(range->near_m, 1.04, 0.08);
    EXPECT_NEAR(range->far_m, 2.96, 0.08);
    EXPECT_FALSE(depth_range(Image<float>(9, 9, 0.0f)));
}

TEST(Keys, EachKeyAndEachActionOnce) {
    for (const KeyEntry& a : key_table()) {
        EXPECT_EQ(action_of(a.key, false), a.action);
        EXPECT_EQ(action_of(a.key, true).has_value(), a.repeats);
        int same_action = 0;
        for (const KeyEntry& b : key_table()) same_action += a.action == b.action;
        EXPECT_EQ(same_action, 1) << a.shown;
        EXPECT_NE(keys_text().find(a.help), std::string::npos);
    }
    EXPECT_EQ(key_table().size(), static_cast<std::size_t>(Action::quit) + 1);
    EXPECT_FALSE(action_of(-1, false));
}

}  // namespace
}  // namespace kino
