#include <gmock/gmock.h>

#include "posed.h"
#include "tests/scenes/depth_scene.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::Not;
using ::testing::StartsWith;

class AvatarDrawing : public VizTest {
  protected:
    /// A wall 3 m before the sensor, which is at the origin and looks along the world's -z.
    static Scene live_wall() {
        const CameraModel camera{
            .width = 80, .height = 60, .fx = 70, .fy = 70, .cx = 39.5, .cy = 29.5};
        Scene scene;
        scene.live = LiveDepth{};
        scene.live->surface = make_surface(
            camera, [](int, int) { return 3.0; },
            [](int, int) {
                return Rgba8{40, 40, 200, 255};
            });
        scene.live->world_from_depth = scene.live->previous_world_from_depth =
            world_from_camera_axes();
        return scene;
    }

    static FrameResult draw(Renderer& renderer, const Scene& scene) {
        const View view{.width = 96,
                        .height = 72,
                        .projection = perspective(0.8, 96, 72),
                        .world_from_view = world_from_camera_axes()};
        auto frame = renderer.render_to_image(scene, view, {.read_picture = true});
        EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
        return frame ? std::move(*frame) : FrameResult{};
    }
};

// An avatar stands before the live picture; with nobody there it costs nothing at all.
TEST_F(AvatarDrawing, OverTheLiveCloudAndForNothingWhenNobodyIsThere) {
    Renderer renderer(device());
    AvatarTroupe troupe(rig_called("mannequin"), {.hand_over_s = 0, .idle = false});
    const auto scene_now = [&] {
        Scene scene = live_wall();
        troupe.fill(scene, 20);
        return scene;
    };
    const auto none = [&](const FrameResult& frame) {
        EXPECT_THAT(frame.report.passes, Each(Not(StartsWith("meshes"))));
        EXPECT_EQ(renderer.mesh_bytes(), 0u);
    };
    const FrameResult before = draw(renderer, scene_now());
    none(before);
    EXPECT_THAT(renderer.pipelines().names(), Each(Not(StartsWith("meshes"))));

    const PosedBody person = person_at(Motion::tpose, 4, {0, -0.9, -2});
    BodyFrame bodies;
    bodies.bodies = {body_of(person)};
    for (int i = 0; i < 12; ++i) troupe.step(moment_of(bodies));
    const FrameResult with = draw(renderer, scene_now());
    EXPECT_THAT(with.report.passes, Contains("meshes/skin"));
    EXPECT_THAT(renderer.pipelines().names(), Contains("meshes/skin dual"));
    EXPECT_THAT(renderer.pipelines().names(), Not(Contains("meshes/skin")));
    EXPECT_THAT(renderer.pipelines().names(), Each(Not(StartsWith("blended"))));
    EXPECT_GT(renderer.mesh_bytes(), 0u);
    // The middle of its chest covers the wall, the corner of the picture still shows it.
    const glm::dvec3 chest = glm::mix(person[Joint::spine], person[Joint::shoulder_center], 0.5);
    const double f = 36 / std::tan(0.4);
    const int x = static_cast<int>(std::lround(47.5 + f * chest.x / -chest.z));
    const int y = static_cast<int>(std::lround(35.5 - f * chest.y / -chest.z));
    EXPECT_NE(with.picture.at(x, y), before.picture.at(x, y));
    EXPECT_EQ(with.picture.at(2, 2), before.picture.at(2, 2));

    AvatarMoment nobody;
    nobody.dt_s = 0.1;
    troupe.step(nobody);
    const FrameResult after = draw(renderer, scene_now());
    none(after);
    for (std::size_t i = 0; i < before.picture.size(); ++i) {
        ASSERT_EQ(before.picture.pixels()[i], after.picture.pixels()[i]);
    }
}

}  // namespace
}  // namespace kino::test
