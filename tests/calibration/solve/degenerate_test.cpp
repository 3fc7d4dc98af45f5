#include <gmock/gmock.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/solve/calibrate.h"
#include "calibration/solve/pair_checks.h"
#include "tests/calibration/solve/synthetic_boards.h"

namespace kino {
namespace {

using test::make_scene;
using test::photograph;
using test::typical_rig;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

CalibrateOptions brown4_only() {
    CalibrateOptions options;
    options.models = {LensModel::brown4};
    return options;
}

std::string complaint(const Shots& shots) {
    const auto found = calibrate(shots, brown4_only());
    return found ? "no complaint" : found.error().to_string();
}

TEST(Degenerate, OneView) {
    const auto scene = make_scene(typical_rig(), {.views = 1});
    EXPECT_THAT(
        complaint(photograph(scene, 0.1, 1)),
        AllOf(HasSubstr("1 view shows the board; at least 3 are needed"), HasSubstr("infrared")));
}

TEST(Degenerate, BoardsAllParallel) {
    const auto scene = make_scene(typical_rig(), {.largest_tilt_deg = 1.0});
    EXPECT_THAT(complaint(photograph(scene, 0.1, 1)),
                AllOf(HasSubstr("all boards are parallel to each other within"),
                      HasSubstr("tilt the board")));
    // Parallel, but not to the picture: as useless.
    auto tilted = scene;
    for (Pose& pose : tilted.first_from_board) {
        const glm::dquat turn = glm::angleAxis(0.5, glm::dvec3(0, 1, 0));
        const glm::dvec3 middle = pose * glm::dvec3(0.14, 0.0875, 0);
        pose.rotation = glm::normalize(turn * pose.rotation);
        pose.translation = middle - pose.rotation * glm::dvec3(0.14, 0.0875, 0);
    }
    EXPECT_THAT(complaint(photograph(tilted, 0.1, 1)), HasSubstr("parallel to each other"));
}

TEST(Degenerate, BoardsInOneCorner) {
    auto scene = make_scene(typical_rig(), {.nearest_m = 1.6, .farthest_m = 1.7, .spread = 0.1});
    for (Pose& pose : scene.first_from_board) pose.translation += glm::dvec3(-0.5, -0.35, 0);
    EXPECT_THAT(complaint(photograph(scene, 0.05, 1)),
                AllOf(HasSubstr("one part of the picture only (the upper left corner"),
                      HasSubstr("every corner")));
}

TEST(Degenerate, BoardMovedBetweenThePictures) {
    const auto scene = make_scene(typical_rig(), {.seed = 3});
    Shots shots = photograph(scene, 0.1, 1);
    auto moved = scene;
    for (const std::size_t view : {std::size_t{4}, std::size_t{11}}) {
        moved.first_from_board[view].translation += glm::dvec3(0.004, 0.006, 0.002);
    }
    const Shots later = photograph(moved, 0.1, 2);
    for (const std::size_t view : {std::size_t{4}, std::size_t{11}}) {
        shots.cameras[1].views[view] = later.cameras[1].views[view];
    }
    const auto found = calibrate(shots, brown4_only());
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_EQ(found->views.size(), 18u);
    EXPECT_THAT(found->notes, Contains(HasSubstr("view 4: the board moved between the two")));
    EXPECT_THAT(found->notes, Contains(HasSubstr("view 11: the board moved between the two")));
    const Pose step = inverse(scene.rig.color_from_depth) * found->second_from_first;
    EXPECT_LT(glm::length(step.translation), 0.002);
}

TEST(Degenerate, TwoBoardSizesMixed) {
    const auto scene = make_scene(typical_rig(), {.seed = 6});
    auto larger = scene;
    for (auto& corner : larger.corners_m) corner *= 1.4;
    for (Pose& pose : larger.first_from_board) pose.translation *= 1.4;
    Shots shots = photograph(scene, 0.05, 1);
    const Shots other = photograph(larger, 0.05, 2);
    for (const std::size_t view : {std::size_t{2}, std::size_t{7}}) {
        for (std::size_t c = 0; c < 2; ++c) {
            shots.cameras[c].views[view] = other.cameras[c].views[view];
        }
    }
    const auto found = calibrate(shots, brown4_only());
    ASSERT_TRUE(found) << found.error().to_string();
    for (const char* view : {"view 2", "view 7"}) {
        EXPECT_THAT(found->notes,
                    Contains(AllOf(HasSubstr(view), HasSubstr("boards of two sizes are mixed"),
                                   testing::ContainsRegex(" 1[.](3[5-9]|4[0-5]) times"))));
    }
}

TEST(Degenerate, OneCameraMirrored) {
    const auto scene = make_scene(typical_rig(), {.seed = 7});
    Shots shots = photograph(scene, 0.1, 1);
    shots.cameras[1] = mirrored(shots, 1);
    EXPECT_THAT(complaint(shots), AllOf(HasSubstr("color: these pictures are mirrored"),
                                        HasSubstr("switch the mirroring")));
}

TEST(Degenerate, PicturesOfDifferentScenesPaired) {
    const Shots a = photograph(make_scene(typical_rig(), {.seed = 12}), 0.1, 1);
    const Shots b = photograph(make_scene(typical_rig(), {.seed = 13}), 0.1, 1);
    Shots shots = a;
    shots.cameras[1] = b.cameras[1];
    EXPECT_THAT(complaint(shots), HasSubstr("no fixed pose between the cameras explains"));
}

TEST(Degenerate, CamerasThatNeverSeeTheBoardTogether) {
    Shots shots = photograph(make_scene(typical_rig(), {.seed = 14}), 0.1, 1);
    for (std::size_t view = 0; view < 20; ++view) shots.cameras[view % 2].views[view].clear();
    EXPECT_THAT(complaint(shots), HasSubstr("no view shows the board to both infrared and color"));
}

TEST(Degenerate, DistortionThatCannotBeSeenIsHeldAndNamed) {
    // Far away in the middle: hardly a ray leaves the axis by more than some degrees.
    RigParameters rig = typical_rig();
    for (CameraModel* c : {&rig.depth, &*rig.color}) {
        c->fx *= 3;
        c->fy *= 3;
        c->k1 = c->k2 = c->p1 = c->p2 = 0;
    }
    const auto scene = make_scene(rig, {.nearest_m = 1.2, .farthest_m = 2, .seed = 15});
    CalibrateOptions options;
    options.models = {LensModel::brown5};
    const auto found = calibrate(photograph(scene, 0.2, 1), options);
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_THAT(found->notes, Contains(HasSubstr("infrared: k3 is held at 0")));
    const SolvedNumber& k3 = found->cameras[0].numbers[8];
    EXPECT_EQ(k3.name, "k3");
    EXPECT_TRUE(k3.held);
    EXPECT_EQ(k3.value, 0);
    EXPECT_EQ(k3.sigma, 0);
    EXPECT_FALSE(found->cameras[0].numbers[4].held);
}

}  // namespace
}  // namespace kino
