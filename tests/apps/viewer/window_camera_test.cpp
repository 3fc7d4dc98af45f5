#include "apps/viewer/window_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace kino {
namespace {

TimeNs fake_now() {
    return kNsPerSecond * 4;
}

BodyFrame somebody(const glm::vec3& head_m) {
    BodyFrame frame;
    frame.bodies.push_back({.id = 1});
    frame.bodies[0][Joint::head] = {
        .position_m = head_m, .state = JointState::tracked, .confidence = 1};
    return frame;
}

glm::dvec3 eye_seen(const SceneWindow& window, const glm::vec3& head_m) {
    WindowCamera camera(window);
    for (int i = 0; i < 90; ++i) {
        const BodyFrame frame = somebody(head_m);
        camera.see(i * kNsPerSecond / 30, &frame);
    }
    return camera.view({}, 89 * kNsPerSecond / 30, 320, 180).world_from_view.translation;
}

TEST(WindowCamera, HeadsLeadTheEyeFromTheSensorsSpaceIntoTheStages) {
    // The sensor 0.2 m above the screen's centre looks at the viewer: its right is their left.
    SceneWindow window{.at_m = {0, 1.2, 0}, .sensor_m = {0, 0.2, 0}};
    EXPECT_LT(glm::distance(eye_seen(window, {0.3f, 0.1f, 1.0f}), {-0.3, 1.2 + 0.2 - 0.1, 0.92}),
              1e-3);
    // Tilted up by 90 degrees it would see what is above it before itself.
    window.sensor_tilt_deg = 30;
    const double c = std::cos(std::acos(-1) / 6), s = 0.5;
    EXPECT_LT(glm::distance(eye_seen(window, {0, 0, 1}), {0, 1.2 + 0.2 + s, c - 0.08}), 1e-3);
    // Turned by 90 degrees about y the viewer stands on the stage's +x.
    window.sensor_tilt_deg = 0;
    window.turn_deg = 90;
    EXPECT_LT(glm::distance(eye_seen(window, {0, 0.2f, 1.0f}), {0.92, 1.2, 0}), 1e-3);
}

TEST(WindowCamera, PicturesAreDeflectedOnlyWhereTheHeadMoves) {
    WindowCamera camera({.deflect = SceneDeflect::homography});
    EXPECT_FALSE(camera.deflection({}, fake_now(), 320, 180, fake_now));
    const TimeNs step = kNsPerSecond / 30;
    for (int i = 0; i < 30; ++i) {
        const BodyFrame frame = somebody({0.02f * static_cast<float>(i), 0, 1});
        camera.see(fake_now() - (30 - i) * step, &frame);
    }
    const TimeNs drawn_for = fake_now() - step;
    const auto moving = camera.deflection({}, drawn_for, 320, 180, fake_now);
    ASSERT_TRUE(moving);
    EXPECT_EQ(moving->form, DeflectForm::homography);
    EXPECT_EQ(moving->guard_px, 10);
    EXPECT_LT(glm::distance(moving->newest().world_from_view.translation,
                            camera.view({}, fake_now(), 320, 180).world_from_view.translation),
              1e-12);
    EXPECT_NE(moving->newest(), camera.view({}, drawn_for, 320, 180));
    WindowCamera still({.deflect = SceneDeflect::none});
    const BodyFrame frame = somebody({0, 0, 1});
    still.see(0, &frame);
    EXPECT_FALSE(still.deflection({}, 0, 320, 180, fake_now));
    still.see(1, nullptr);
    camera.reset();
    EXPECT_FALSE(camera.deflection({}, fake_now(), 320, 180, fake_now));
}

TEST(WindowCamera, TellsHowFastTheHeadMoves) {
    WindowCamera camera{SceneWindow{}};
    EXPECT_EQ(camera.head_m_s(0), glm::dvec3(0));
    const TimeNs step = kNsPerSecond / 30;
    for (int i = 0; i < 60; ++i) {
        // At rest, then 1.2 m/s to the sensor's right, the viewer's left.
        const BodyFrame frame = somebody({0.04f * static_cast<float>(std::max(0, i - 30)), 0, 2});
        camera.see(i * step, &frame);
        if (i == 30) {
            EXPECT_LT(glm::length(camera.head_m_s(i * step)), 1e-6);
        }
    }
    EXPECT_LT(glm::distance(camera.head_m_s(59 * step), {-1.2, 0, 0}), 0.1);
}

}  // namespace
}  // namespace kino
