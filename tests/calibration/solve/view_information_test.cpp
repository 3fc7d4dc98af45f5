#include "calibration/solve/view_information.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "calibration/solve/bundle.h"
#include "calibration/solve/start.h"
#include "tests/calibration/solve/synthetic_boards.h"

namespace kino {
namespace {

struct OneCamera {
    Shots shots;
    Lens lens{};
    std::vector<Pose> poses;
};

OneCamera one_camera(int views) {
    const auto scene =
        test::make_scene(test::typical_rig(), {.views = views, .least_tilt_deg = 15, .seed = 21});
    return {only_camera(test::photograph(scene, 0.2, 22), 0), lens_of(scene.rig.depth),
            scene.first_from_board};
}

LensInformation information(const OneCamera& one, std::size_t view) {
    return view_information(one.shots.corners_m, one.shots.cameras[0].views[view], one.lens,
                            one.poses[view]);
}

// The joint problem's own deviations, which are derived another way, for the same views.
TEST(ViewInformation, AddsUpToTheDeviationsOfTheSolve) {
    const OneCamera one = one_camera(20);
    LensInformation sum;
    for (std::size_t view = 0; view < 20; ++view) sum += information(one, view);
    const auto expected = expected_deviations(sum, one.lens, 0.2);
    auto solved = solve_camera(one.shots, LensModel::brown4);
    ASSERT_TRUE(solved);
    solved->sigma_px = 0.2;
    const auto stated =
        bundle_deviations(one.shots, *solved, freedom_of({LensModel::brown4}), {.huber_sigmas = 0});
    for (std::size_t i = 0; i < LensInformation::kNumbers; ++i) {
        EXPECT_NEAR(expected[i], stated.lenses[0][i], 0.05 * stated.lenses[0][i]) << kLensNames[i];
    }
}

TEST(ViewInformation, AViewPromisesLessTheMoreThereAre) {
    const OneCamera one = one_camera(12);
    LensInformation sum;
    double before = 1;
    for (int repeat = 0; repeat < 4; ++repeat) {
        const double fall = expected_fall(sum, information(one, 0), one.lens, 0.3);
        EXPECT_GT(fall, 0);
        EXPECT_LT(fall, before);
        before = fall;
        sum += information(one, 0);
    }
    // Another stand of the board promises more than the same once more.
    EXPECT_GT(expected_fall(sum, information(one, 1), one.lens, 0.3),
              3 * expected_fall(sum, information(one, 0), one.lens, 0.3));
    EXPECT_EQ(expected_fall(sum, LensInformation{}, one.lens, 0.3), 0);
}

// Boards that face the camera cannot tell the focal length from the distance.
TEST(ViewInformation, FlatBoardsSayLittleOfTheFocalLength) {
    const OneCamera one = one_camera(3);
    const auto deviation = [&](double tilt) {
        LensInformation sum;
        for (const double around : {0.0, 1.5, 3.0, 4.5}) {
            const glm::dquat rotation =
                glm::angleAxis(tilt, glm::dvec3(std::cos(around), std::sin(around), 0));
            const glm::dvec3 place(0.05 * std::cos(around), 0.05, 0.5 + 0.04 * around);
            const Pose pose{rotation, place - rotation * glm::dvec3(0.14, 0.0875, 0)};
            sum += view_information(one.shots.corners_m, one.shots.cameras[0].views[0], one.lens,
                                    pose);
        }
        return expected_deviations(sum, one.lens, 0.3)[0];
    };
    EXPECT_GT(deviation(0), 10 * deviation(0.6));
}

}  // namespace
}  // namespace kino
