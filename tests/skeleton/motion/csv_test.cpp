#include <gtest/gtest.h>

#include <charconv>
#include <limits>

#include "tests/skeleton/motion/csv_reader.h"
#include "tests/skeleton/motion/test_clips.h"

namespace kino::test {
namespace {

template <class T>
T number(const std::string& text) {
    T value{};
    const auto end = text.data() + text.size();
    const auto got = std::from_chars(text.data(), end, value);
    EXPECT_TRUE(got.ec == std::errc() && got.ptr == end) << text;
    return value;
}

TEST(Csv, GivesEveryBitBack) {
    MotionClip clip = synthetic_clip(Motion::dance, 50);
    for (std::size_t i = 0; i < clip.moments.size(); ++i) {
        auto& joints = clip.moments[i].bodies.bodies[0].joints;
        joints[i % 20].confidence = 1.0F / static_cast<float>(i + 3);
        joints[i % 20].state = JointState::inferred;
    }
    clip.rate_hz = 7;  // CSV is never resampled
    MotionSummary summary;
    const auto rows = read_csv(written(clip, "a.csv", &summary));
    EXPECT_EQ(summary.frames, 50U);
    EXPECT_NEAR(summary.rate_hz, 30, 1e-5);
    ASSERT_EQ(rows.size(), 50U * 20);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const auto& row = rows[r];
        const MotionMoment& moment = clip.moments[r / 20];
        const JointPosition& p = moment.bodies.bodies[0].joints[r % 20];
        EXPECT_EQ(number<std::size_t>(row.at("moment")), r / 20);
        EXPECT_EQ(number<TimeNs>(row.at("time_ns")), moment.bodies.time);
        EXPECT_EQ(number<std::uint32_t>(row.at("person")), kPerson);
        EXPECT_EQ(row.at("joint"), joint_name(static_cast<Joint>(r % 20)));
        EXPECT_EQ(row.at("state"), p.state == JointState::tracked ? "tracked" : "inferred");
        EXPECT_EQ(number<float>(row.at("confidence")), p.confidence);
        const glm::dvec3 world = moment.world_from_depth * glm::dvec3(p.position_m);
        EXPECT_EQ(number<float>(row.at("x_m")), p.position_m.x);
        EXPECT_EQ(number<float>(row.at("y_m")), p.position_m.y);
        EXPECT_EQ(number<float>(row.at("z_m")), p.position_m.z);
        EXPECT_EQ(number<double>(row.at("world_x_m")), world.x);
        EXPECT_EQ(number<double>(row.at("world_y_m")), world.y);
        EXPECT_EQ(number<double>(row.at("world_z_m")), world.z);
    }
}

TEST(Csv, LostJointsHaveNoPlaceAndAbsenceNoRows) {
    MotionClip clip = synthetic_clip(Motion::idle, 10);
    clip.moments[0].bodies.bodies.clear();
    clip.moments[4].bodies.bodies.clear();
    Body& body = clip.moments[6].bodies.bodies[0];
    body[Joint::head].position_m.z = std::numeric_limits<float>::infinity();
    body[Joint::head].confidence = std::numeric_limits<float>::quiet_NaN();
    body[Joint::spine].state = JointState::lost;
    MotionSummary summary;
    const auto rows = read_csv(written(clip, "a.csv", &summary));
    EXPECT_EQ(summary.frames, 8U);
    EXPECT_EQ(summary.moments, 9U);
    ASSERT_EQ(rows.size(), 8U * 20);
    std::size_t lost = 0;
    for (const auto& row : rows) {
        EXPECT_NE(row.at("moment"), "4");
        EXPECT_NE(row.at("moment"), "0");
        if (row.at("state") != "lost") continue;
        ++lost;
        EXPECT_EQ(row.at("moment"), "6");
        EXPECT_EQ(row.at("x_m") + row.at("z_m") + row.at("world_z_m"), "");
        EXPECT_GE(number<float>(row.at("confidence")), 0);
    }
    EXPECT_EQ(lost, 2U);
}

}  // namespace
}  // namespace kino::test
