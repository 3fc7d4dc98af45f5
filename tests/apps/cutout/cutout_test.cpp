#include "apps/stage/cutout.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "calibration/rig.h"
#include "skeleton/synthetic/synthetic_source.h"
#include "tests/support/random.h"

namespace kino {
namespace {

constexpr double kMarginM = 0.16;
constexpr std::array<Joint, 10> kUpperBody = {
    Joint::shoulder_center, Joint::head,      Joint::shoulder_left,  Joint::elbow_left,
    Joint::wrist_left,      Joint::hand_left, Joint::shoulder_right, Joint::elbow_right,
    Joint::wrist_right,     Joint::hand_right};

/// A computed person, and what of the picture is theirs.
struct Shown {
    std::shared_ptr<DepthSurface> surface;
    Image<PartId> part;
    BodyFrame bodies;
    Pose world_from_depth;
    double floor_y_m = 0;
    double table_y_m = -1;  ///< whoever sits has nothing below it that anybody tracks
};

struct Score {
    double person = 0, kept = 0, right = 0;
    [[nodiscard]] double recall() const { return right / person; }
    [[nodiscard]] double precision() const { return right / kept; }
    void add(const Shown& shown, const DepthSurface& cut) {
        for (std::size_t i = 0; i < shown.part.size(); ++i) {
            // What the sensor does not see is nobody's fault.
            const double z = shown.surface->depth_m.pixels()[i];
            if (!(z > 0)) continue;
            const RayXy ray = shown.surface->rays->pixels()[i];
            const glm::dvec3 world = shown.world_from_depth * glm::dvec3(ray.x * z, ray.y * z, z);
            if (world.y < shown.table_y_m && is_body_part(shown.part.pixels()[i])) continue;
            const bool theirs = is_body_part(shown.part.pixels()[i]);
            const bool left = cut.depth_m.pixels()[i] > 0;
            person += theirs;
            kept += left;
            right += theirs && left;
        }
    }
};

/// `joint_noise_m`: standard deviation of what joints are off along each axis, as tracked ones are.
Shown shown_at(SyntheticSource& source, std::int64_t index, bool seated, double joint_noise_m) {
    SyntheticTruth truth = source.truth(index);
    Shown shown;
    shown.world_from_depth = source.scene().world_from_depth;
    shown.surface = std::make_shared<DepthSurface>();
    shown.surface->depth_m = std::move(truth.depth_m);
    auto rays = std::make_shared<Image<RayXy>>();
    const auto rig = Rig::create(source.scene().rig);
    *rays = rig->depth_rays();
    shown.surface->rays = rays;
    shown.surface->focal_px = source.scene().rig.depth.fx;
    shown.part = std::move(truth.part);
    shown.bodies = std::move(truth.bodies);
    test::Random random(static_cast<std::uint64_t>(index) + 7);
    for (Body& body : shown.bodies.bodies) {
        for (JointPosition& joint : body.joints) {
            for (int k = 0; k < 3; ++k) {
                joint.position_m[k] += static_cast<float>(joint_noise_m * random.real(-1.7, 1.7));
            }
        }
        if (!seated) continue;
        Body upper = body;
        for (JointPosition& joint : upper.joints) joint = {};
        for (const Joint joint : kUpperBody) upper[joint] = body[joint];
        body = upper;
    }
    return shown;
}

/// Somebody before a chair's back and behind a table, their lower body not tracked: what a camera
/// on a desk sees.
struct Desk {
    SyntheticScene scene;
    double top_y_m = 0;
};
Desk desk_scene(Motion motion) {
    SyntheticScene scene = make_scene(motion, 320, 240);
    const Body body = scene.bodies_at(0).front();
    const glm::dvec3 hips = scene.world_from_depth * glm::dvec3(body[Joint::hip_center].position_m);
    glm::dvec3 to_camera = scene.world_from_depth.translation - hips;
    to_camera.y = 0;
    to_camera = glm::normalize(to_camera);
    const glm::dvec3 up(0, 1, 0);
    const glm::dmat3 turn(glm::cross(up, to_camera), up, to_camera);
    scene.furniture.push_back(box(hips - 0.24 * to_camera + 0.42 * up, {0.36, 0.4, 0.03},
                                  kPartChair, Covering::black, turn));
    scene.furniture.push_back(box(hips + 0.55 * to_camera + 0.02 * up, {0.7, 0.02, 0.3}, kPartTable,
                                  Covering::wood, turn));
    return {scene, hips.y + 0.04};
}

Score score_of(const SyntheticScene& scene, bool seated, double noise_m, double table_y_m = -1) {
    auto source = SyntheticSource::create(scene);
    Score score;
    EXPECT_TRUE(source.has_value());
    for (const std::int64_t index : {10, 75, 140, 205, 270}) {
        Shown shown = shown_at(**source, index, seated, noise_m);
        shown.table_y_m = table_y_m;
        score.add(shown, *cut_out_people(*shown.surface, shown.bodies, kMarginM,
                                         shown.world_from_depth, shown.floor_y_m));
    }
    return score;
}

TEST(CutoutTest, KeepsWhoStands) {
    for (const Motion motion : {Motion::dance, Motion::raise, Motion::squat, Motion::turn}) {
        const Score score = score_of(make_scene(motion, 320, 240), false, 0.02);
        EXPECT_GT(score.recall(), 0.98) << motion_name(motion);
        EXPECT_GT(score.precision(), 0.995) << motion_name(motion);
    }
}

// The chair's back is 24 cm behind them and the table under their hands; spheres round the bones
// alone took both along (precision 0.6).
TEST(CutoutTest, KeepsWhoSitsAtATableAndNothingElse) {
    for (const Motion motion : {Motion::dance, Motion::wave, Motion::raise}) {
        const Desk desk = desk_scene(motion);
        const Score score = score_of(desk.scene, true, 0.02, desk.top_y_m);
        EXPECT_GT(score.recall(), 0.98) << motion_name(motion);
        EXPECT_GT(score.precision(), 0.98) << motion_name(motion);
    }
}

// What hovers near a limb without touching it is not the limb, however near the bone it is.
TEST(CutoutTest, WhatHoversGoes) {
    SyntheticScene scene = make_scene(Motion::tpose, 320, 240);
    const Body body = scene.bodies_at(0).front();
    const glm::dvec3 elbow =
        scene.world_from_depth * glm::dvec3(body[Joint::elbow_left].position_m);
    scene.furniture.push_back(
        box(elbow - glm::dvec3(0, 0.11, 0), {0.05, 0.015, 0.03}, kPartThing, Covering::red));
    const Score score = score_of(scene, false, 0);
    EXPECT_GT(score.recall(), 0.98);
    EXPECT_EQ(score.precision(), 1.0);
}

TEST(CutoutTest, NobodyLeavesNothing) {
    auto source = SyntheticSource::create(make_scene(Motion::idle, 320, 240));
    ASSERT_TRUE(source.has_value());
    Shown shown = shown_at(**source, 3, false, 0);
    for (const bool lost : {true, false}) {
        for (Body& body : shown.bodies.bodies) {
            for (JointPosition& joint : body.joints) {
                joint.state = lost ? JointState::lost : JointState::tracked;
                joint.position_m = glm::vec3(lost ? 0.0f : std::nanf(""));
            }
        }
        const auto cut = cut_out_people(*shown.surface, shown.bodies, kMarginM,
                                        shown.world_from_depth, std::nullopt);
        for (const float z : cut->depth_m.pixels()) ASSERT_EQ(z, 0.0f);
        EXPECT_EQ(cut->version, shown.surface->version);
    }
}

}  // namespace
}  // namespace kino
