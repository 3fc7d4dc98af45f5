#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/skeleton/motion/c3d_reader.h"
#include "tests/skeleton/motion/test_clips.h"

namespace kino::test {
namespace {

TEST(C3d, HoldsThePointsInMillimetres) {
    for (const Motion motion : all_motions()) {
        const MotionClip clip = synthetic_clip(motion);
        const C3dFile file = read_c3d(written(clip, "a.c3d"));
        const Places wanted = world_places(clip);
        ASSERT_EQ(file.frames.size(), wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            for (std::size_t j = 0; j < kJointCount; ++j) {
                const C3dPoint& p = file.frames[i][j];
                ASSERT_EQ(p.x, static_cast<float>(1000 * wanted[i][j].x));
                ASSERT_EQ(p.y, static_cast<float>(1000 * wanted[i][j].y));
                ASSERT_EQ(p.z, static_cast<float>(1000 * wanted[i][j].z));
                ASSERT_EQ(p.residual, 0);
            }
        }
    }
}

TEST(C3d, HeaderAndParametersAgree) {
    MotionClip clip = synthetic_clip(Motion::idle, 45);
    clip.rate_hz = 0;  // the clip's own
    MotionSummary summary;
    const C3dFile file = read_c3d(written(clip, "a.c3d", &summary));
    EXPECT_NEAR(summary.rate_hz, 30, 1e-5);
    EXPECT_NEAR(file.rate_hz, 30, 1e-5);
    EXPECT_EQ(file.first_frame, 1);
    EXPECT_EQ(file.last_frame, 45);
    const auto& p = file.parameters;
    EXPECT_EQ(p.at("POINT:USED").integer(), 20);
    EXPECT_EQ(p.at("POINT:FRAMES").integer(), 45);
    EXPECT_EQ(p.at("POINT:DATA_START").integer(), file.data_block);
    EXPECT_EQ(p.at("POINT:RATE").real(), file.rate_hz);
    EXPECT_EQ(p.at("POINT:SCALE").real(), file.scale);
    EXPECT_EQ(p.at("TRIAL:ACTUAL_END_FIELD").integer(), 45);
    EXPECT_EQ(p.at("ANALOG:USED").integer(), 0);
    EXPECT_THAT(p.at("POINT:UNITS").texts(), testing::ElementsAre("mm"));
    std::vector<std::string> names;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        names.emplace_back(joint_name(static_cast<Joint>(j)));
    }
    EXPECT_EQ(p.at("POINT:LABELS").texts(), names);
}

TEST(C3d, LostPointsAreMarkedAndNeverBridged) {
    MotionClip clip = synthetic_clip(Motion::wave, 20);
    auto& joints = clip.moments[5].bodies.bodies[0];
    joints[Joint::hand_left].state = JointState::lost;
    joints[Joint::head].position_m.x = std::numeric_limits<float>::quiet_NaN();
    clip.moments[9].bodies.bodies.clear();
    MotionSummary summary;
    const C3dFile file = read_c3d(written(clip, "a.c3d", &summary));
    EXPECT_EQ(summary.joints_lost, 22U);
    for (std::size_t i = 0; i < 20; ++i) {
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const bool lost = i == 9 || (i == 5 && (j == 7 || j == 3));
            const C3dPoint& p = file.frames[i][j];
            EXPECT_EQ(p.residual, lost ? -1 : 0) << i << " " << j;
            EXPECT_EQ(p.x == 0 && p.y == 0 && p.z == 0, lost);
        }
    }
}

TEST(C3d, AHoleInTheRecordingIsNotInterpolated) {
    MotionClip clip = synthetic_clip(Motion::walk, 90);
    clip.moments.erase(clip.moments.begin() + 31, clip.moments.begin() + 59);
    const C3dFile file = read_c3d(written(clip, "a.c3d"));
    ASSERT_EQ(file.frames.size(), 90U);
    for (std::size_t i = 0; i < 90; ++i) {
        EXPECT_EQ(file.frames[i][0].residual, i > 30 && i < 59 ? -1 : 0) << i;
    }
    // One frame a second is no hole: that is its rate.
    MotionClip slow = synthetic_clip(Motion::walk, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        slow.moments[i].bodies.time = static_cast<TimeNs>(i) * kNsPerSecond;
    }
    slow.rate_hz = 2;
    const C3dFile between = read_c3d(written(slow, "a.c3d"));
    ASSERT_EQ(between.frames.size(), 7U);
    for (const auto& f : between.frames) EXPECT_EQ(f[0].residual, 0);
}

}  // namespace
}  // namespace kino::test
