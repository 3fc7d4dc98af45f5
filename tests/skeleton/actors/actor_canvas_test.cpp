#include "skeleton/actors/actor_canvas.h"

#include <gtest/gtest.h>

#include <cmath>

#include "skeleton/actors/actor_stage.h"
#include "skeleton/actors/actor_truth.h"
#include "skeleton/actors/mesh_raster.h"
#include "skeleton/actors/pose_draw.h"
#include "tests/skeleton/actors/mesh_reference.h"
#include "tests/support/random.h"

namespace kino {
namespace {

struct Posed {
    ActorBody body;
    PosedBones bones;
    std::vector<glm::vec3> view;
};

Posed posed_at(const ActorLook& look, ActorPose pose, glm::dvec2 place,
               const Pose& view_from_world) {
    Posed out{make_actor_body(look), {}, {}};
    pose.place_m = place;
    out.bones = pose_actor(out.body, pose, out.view);
    to_view(view_from_world, out.view);
    return out;
}

// Where the two differ, the ray must pass an edge within a hundredth of a pixel.
TEST(ActorCanvas, AgreesWithTryingEveryTriangle) {
    ActorCanvas canvas(default_kinect1_rig(320, 240));
    const CameraModel& camera = canvas.camera();
    ActorRandom random{31};
    test::Random pixels(32);
    int body_pixels = 0;
    for (int view = 0; view < 12; ++view) {
        const Pose view_from_world =
            inverse(camera_pose(random.in(0.5, 2.2), random.in(-0.2, 0.3)));
        const Posed actor =
            posed_at(random_look(random.bits()), turned(draw_pose(random).pose, random.in(-3, 3)),
                     {random.in(-0.3, 0.3), -random.in(1.0, 3.5)}, view_from_world);
        canvas.clear(canvas.whole(), 50);
        canvas.draw(actor.body, actor.view, 1);
        const raycast::Rect near = mesh_bounds(actor.view, camera);
        for (int i = 0; i < 250; ++i) {
            const int x = pixels.integer(near.x0, near.x1 - 1),
                      y = pixels.integer(near.y0, near.y1 - 1);
            const std::int32_t id = canvas.id().at(x, y);
            const auto agrees = [&](double dx, double dy) {
                const test::MeshHit hit =
                    test::hit_mesh(actor.body, actor.view, (x + dx - camera.cx) / camera.fx,
                                   (y + dy - camera.cy) / camera.fy);
                if (hit.part < 0) return id == kSceneId;
                return id == kActorId + hit.part &&
                       std::abs(double(canvas.z_m().at(x, y)) - hit.z_m) < 2e-3 * hit.z_m;
            };
            bool same = agrees(0, 0);
            for (int k = 0; k < 8 && !same; ++k) {
                same = agrees(0.01 * std::cos(k * M_PI / 4), 0.01 * std::sin(k * M_PI / 4));
            }
            EXPECT_TRUE(same) << "view " << view << " pixel " << x << "," << y;
            body_pixels += id != kSceneId;
        }
    }
    EXPECT_GT(body_pixels, 400);
}

// The whole chain at once: mesh, weights, labels, poses and raster.
TEST(ActorCanvas, AMirroredPoseIsTheMirroredPicture) {
    ActorCanvas one(default_kinect1_rig(320, 240)), two(default_kinect1_rig(320, 240));
    ActorRandom random{33};
    const Pose view_from_world = inverse(camera_pose(1.2, 0.05));
    for (int i = 0; i < 6; ++i) {
        ActorLook look = random_look(random.bits());
        const ActorPose pose = turned(draw_pose(random).pose, random.in(-1, 1));
        const Posed a = posed_at(look, pose, {0.2, -2.3}, view_from_world);
        const Posed b = posed_at(look, mirrored(pose), {-0.2, -2.3}, view_from_world);
        one.clear(one.whole(), 50);
        one.draw(a.body, a.view, 1);
        two.clear(two.whole(), 50);
        two.draw(b.body, b.view, 1);
        int seen = 0, same = 0;
        for (int y = 0; y < 240; ++y) {
            for (int x = 0; x < 320; ++x) {
                const std::int32_t p = one.id().at(x, y), q = two.id().at(319 - x, y);
                if (p == kSceneId && q == kSceneId) continue;
                ++seen;
                same += p != kSceneId && q != kSceneId &&
                        mirrored(static_cast<BodyPart>(part_of(p))) ==
                            static_cast<BodyPart>(part_of(q)) &&
                        std::abs(one.z_m().at(x, y) - two.z_m().at(319 - x, y)) < 0.01f;
            }
        }
        EXPECT_GT(seen, 2000);
        // Diagonals of quads and hand-painted midlines are not mirrored.
        EXPECT_GT(same, 0.97 * seen);
    }
}

TEST(ActorCanvas, WithoutNoiseReadsTheNearestStep) {
    ActorCanvas canvas(default_kinect1_rig(320, 240));
    const Disparity disparity;
    const Posed actor = posed_at({}, ActorPose{}, {0, -2}, inverse(camera_pose(1, 0)));
    canvas.clear(canvas.whole(), 3.5f);
    canvas.draw(actor.body, actor.view, 1);
    const Image<float> z = canvas.z_m();
    Image<float> depth(320, 240);
    canvas.measure(nullptr, 1, depth);
    int readings = 0, lost = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
        const double reading = static_cast<double>(depth.pixels()[i]),
                     truth = static_cast<double>(z.pixels()[i]);
        if (reading == 0) {
            ++lost;
            continue;
        }
        ++readings;
        ASSERT_LT(std::abs(reading - truth), 0.51 * disparity.step_m(truth));
    }
    EXPECT_GT(readings, 65000);
    EXPECT_GT(lost, 500);  // the projector's shadow beside the body
}

// The shadow lies to the left of what throws it, as wide as the parallax of the two depths.
TEST(ActorCanvas, ShadowHasTheWidthOfTheParallax) {
    const RigParameters rig = default_kinect1_rig(640, 480);
    ActorCanvas canvas(rig);
    canvas.clear(canvas.whole(), 3.0f);
    const std::vector<Primitive> slab{
        box({0, 0, 1.55}, {0.2, 2, 0.05}, kPartThing, Covering::wood)};
    canvas.draw(slab, kSceneId);
    Image<float> depth(640, 480);
    canvas.measure(nullptr, 1, depth);
    int lost = 0;
    for (int x = 0; x < 640; ++x) lost += depth.at(x, 240) == 0;
    EXPECT_NEAR(lost, rig.depth.fx * 0.075 * (1 / 1.5 - 1 / 3.0), 1.5);
    const int left = static_cast<int>(rig.depth.cx - 0.2 / 1.5 * rig.depth.fx);
    EXPECT_EQ(depth.at(left - 3, 240), 0);
    EXPECT_GT(depth.at(640 - left + 3, 240), 0);
}

TEST(ActorCanvas, NoiseHasItsSigma) {
    ActorCanvas canvas(default_kinect1_rig(320, 240));
    canvas.clear(canvas.whole(), 2.0f);
    Image<float> depth(320, 240);
    CanvasNoise noise;
    canvas.measure(&noise, 7, depth);
    double sum = 0, squares = 0;
    for (const float z : depth.pixels()) {
        ASSERT_GT(z, 0);
        sum += double(z) - 2.0;
        squares += (double(z) - 2.0) * (double(z) - 2.0);
    }
    const double step = Disparity().step_m(2.0), n = static_cast<double>(depth.size());
    EXPECT_NEAR(sum / n, 0, 0.5 * step);
    // Rounding to whole steps adds a twelfth of a step squared.
    EXPECT_NEAR(std::sqrt(squares / n) / step, std::sqrt(0.46 * 0.46 + 1.0 / 12), 0.12);
}

TEST(ActorTruth, SaysWhatIsSeen) {
    ActorCanvas canvas(default_kinect1_rig(320, 240));
    const Pose view_from_world = inverse(camera_pose(1.0, 0));
    const auto states = [&](const ActorPose& pose, double distance,
                            std::span<const Primitive> solids) {
        const Posed actor = posed_at({}, pose, {0, -distance}, view_from_world);
        canvas.clear(canvas.whole(), 6);
        canvas.draw(actor.body, actor.view, 1);
        canvas.draw(solids, kSceneId);
        return actor_truth(actor.bones, view_from_world, 1, canvas.z_m(), canvas.id(),
                           canvas.camera());
    };
    const ActorPose standing = actor_pose(pose_body(standing_pose()));
    for (const JointPosition& j : states(standing, 2.6, {}).joints)
        EXPECT_EQ(j.state, JointState::tracked);

    // A desk before the legs, in view space.
    const std::vector<Primitive> desk{
        box({0, 1.2, 1.5}, {2, 1.0, 0.02}, kPartTable, Covering::wood)};
    const Body behind = states(standing, 2.6, desk);
    EXPECT_EQ(behind[Joint::head].state, JointState::tracked);
    EXPECT_EQ(behind[Joint::shoulder_left].state, JointState::tracked);
    for (const Joint j : {Joint::knee_left, Joint::foot_right, Joint::ankle_left}) {
        EXPECT_EQ(behind[j].state, JointState::inferred);
    }
    // Another person close before: what is seen there is not the one behind.
    const Posed back = posed_at({}, standing, {0, -2.6}, view_from_world),
                front = posed_at({}, standing, {0, -2.45}, view_from_world);
    canvas.clear(canvas.whole(), 6);
    canvas.draw(back.body, back.view, 1);
    canvas.draw(front.body, front.view, 2);
    for (const Joint j : {Joint::spine, Joint::head, Joint::knee_left}) {
        EXPECT_EQ(actor_truth(back.bones, view_from_world, 1, canvas.z_m(), canvas.id(),
                              canvas.camera())[j]
                      .state,
                  JointState::inferred);
        EXPECT_EQ(actor_truth(front.bones, view_from_world, 2, canvas.z_m(), canvas.id(),
                              canvas.camera())[j]
                      .state,
                  JointState::tracked);
    }

    // Too near for head and feet.
    const Body near = states(standing, 1.0, {});
    EXPECT_EQ(near[Joint::head].state, JointState::inferred);
    EXPECT_EQ(near[Joint::foot_left].state, JointState::inferred);
    EXPECT_EQ(near[Joint::spine].state, JointState::tracked);
    // Turned to the side the far arm is behind the trunk.
    const Body side = states(turned(standing, M_PI / 2), 2.6, {});
    EXPECT_EQ(side[Joint::shoulder_right].state, JointState::tracked);
    EXPECT_EQ(side[Joint::shoulder_left].state, JointState::inferred);
    EXPECT_EQ(side[Joint::elbow_right].state, JointState::tracked);
    // The person's left is at the picture's right when it faces the camera.
    EXPECT_GT(states(standing, 2.6, {})[Joint::hand_left].position_m.x, 0);
}

}  // namespace
}  // namespace kino
