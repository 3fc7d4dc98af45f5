#include "skeleton/motion/bvh_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/skeleton/motion/bvh_reader.h"
#include "tests/skeleton/motion/test_clips.h"
#include "tests/support/random.h"

namespace kino::test {
namespace {

constexpr double kBvhCm = 0.01;
constexpr double kPi = 3.14159265358979323846;

double worst_m(const MotionClip& clip, MotionSummary* summary = nullptr) {
    const BvhFile file = read_bvh(written(clip, "a.bvh", summary));
    const Places wanted = normalized(world_places(clip));
    EXPECT_EQ(file.frames.size(), wanted.size());
    EXPECT_NEAR(file.frame_time_s, 1.0 / 30, 1e-9);
    double worst = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        worst = std::max(worst, largest_error_m(file.positions(i), kBvhCm, wanted[i]));
    }
    return worst;
}

TEST(Bvh, GivesThePositionsOfEveryMotionBack) {
    for (const Motion motion : all_motions()) {
        MotionSummary summary;
        EXPECT_LT(worst_m(synthetic_clip(motion), &summary), 1e-5) << motion_name(motion);
        // The synthetic person's bones are constant: nothing is lost at all.
        EXPECT_LT(summary.max_error_mm, 0.01);
        EXPECT_EQ(summary.frames, 300U);
        EXPECT_EQ(summary.joints_lost, 0U);
        EXPECT_NEAR(summary.bone_m[static_cast<int>(Joint::elbow_left)], 0.285, 1e-5);
    }
}

TEST(Bvh, GivesRandomPosesBack) {
    // Every bone may point against its rest direction here.
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        EXPECT_LT(worst_m(random_clip(seed, 100)), 1e-5);
}

TEST(Bvh, GivesPosesAtThePolesBack) {
    // Arms straight up, legs straight ahead and behind, heads on the chest: x at 90 degrees.
    const glm::dvec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    Places places;
    for (int limb = 0; limb < 4; ++limb) {
        for (const glm::dvec3& axis : axes) {
            auto p = standing();
            const int first = 4 + 4 * limb;
            for (int k = 1; k < 4; ++k) p[first + k] = p[first + k - 1] + 0.3 * axis;
            places.push_back(p);
            auto bent = p;
            bent[first + 2] = bent[first + 1] + 0.3 * glm::dvec3(axis.y, axis.z, axis.x);
            bent[first + 3] = bent[first + 2] + 0.3 * axis;
            places.push_back(bent);
        }
    }
    for (const glm::dvec3& axis : axes) {
        auto p = standing();
        p[3] = p[2] + 0.2 * axis;
        places.push_back(p);
    }
    EXPECT_LT(worst_m(clip_of(places)), 1e-5);
}

TEST(Bvh, TurnsOfHalfACircleBetweenFrames) {
    Places places;
    for (int i = 0; i < 8; ++i) {
        auto p = standing();
        const double s = i % 2 == 0 ? 1 : -1;
        for (auto& v : p) v = {s * v.x, v.y, s * v.z};
        places.push_back(p);
    }
    EXPECT_LT(worst_m(clip_of(places)), 1e-5);
}

TEST(Bvh, OneFrame) {
    const MotionClip clip = synthetic_clip(Motion::tpose, 1);
    EXPECT_LT(worst_m(clip), 1e-5);
}

TEST(Bvh, EulerAnglesAreTheRotationAndStayNear) {
    Random random(11);
    glm::dvec3 before(0);
    for (int i = 0; i < 3000; ++i) {
        glm::dquat q(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1),
                     random.real(-1, 1));
        if (random.chance(0.3)) {  // exactly at, or very near, a pole
            const double off = random.chance(0.5) ? 0 : random.real(-1e-8, 1e-8);
            q = glm::angleAxis(random.real(-3, 3), glm::dvec3(0, 0, 1)) *
                glm::angleAxis((random.chance(0.5) ? 1 : -1) * kPi / 2 + off, glm::dvec3(1, 0, 0)) *
                glm::angleAxis(random.real(-3, 3), glm::dvec3(0, 1, 0));
        }
        q = glm::normalize(q);
        const glm::dvec3 e = motion_export::euler_zxy(q, before);
        glm::dmat4 m(1);
        m = glm::rotate(m, e.z, glm::dvec3(0, 0, 1));
        m = glm::rotate(m, e.x, glm::dvec3(1, 0, 0));
        m = glm::rotate(m, e.y, glm::dvec3(0, 1, 0));
        const glm::dmat3 wanted = glm::mat3_cast(q);
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r) EXPECT_NEAR(m[c][r], wanted[c][r], 3e-7);
        }
        for (int a = 0; a < 3; ++a) EXPECT_LE(std::abs(e[a] - before[a]), 2 * kPi);
        before = random.chance(0.1) ? glm::dvec3(0) : e;
    }
}

TEST(Bvh, AnglesGoOverThePoleAndRoundTheCircleSteadily) {
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0), before(0);
        unit[axis] = 1;
        for (int step = 0; step <= 200; ++step) {
            const double angle = 0.05 * step;
            before = motion_export::euler_zxy(glm::angleAxis(angle, unit), before);
            EXPECT_LT(glm::length(before - angle * unit), 1e-6) << angle;
        }
    }
}

TEST(Bvh, CurvesHaveNoJumps) {
    for (const Motion motion : all_motions()) {
        const BvhFile file = read_bvh(written(synthetic_clip(motion), "a.bvh"));
        double worst = 0;
        for (std::size_t i = 1; i < file.frames.size(); ++i) {
            for (std::size_t c = 3; c < file.frames[i].size(); ++c) {
                worst = std::max(worst, std::abs(file.frames[i][c] - file.frames[i - 1][c]));
            }
        }
        EXPECT_LT(worst, 180) << motion_name(motion);
    }
}

TEST(Bvh, IsLaidOutAsOtherToolsExpect) {
    const BvhFile file = read_bvh(written(synthetic_clip(Motion::walk, 2), "a.bvh"));
    EXPECT_EQ(file.joints.front().name, "hip_center");
    EXPECT_THAT(file.joints.front().channels,
                testing::ElementsAre("Xposition", "Yposition", "Zposition", "Zrotation",
                                     "Xrotation", "Yrotation"));
    int ends = 0;
    for (const BvhJoint& j : file.joints) ends += j.end_site ? 1 : 0;
    EXPECT_EQ(ends, 5);
    EXPECT_EQ(file.joints.size(), 30U);  // 20 joints, 5 that start a branch, 5 ends
}

}  // namespace
}  // namespace kino::test
