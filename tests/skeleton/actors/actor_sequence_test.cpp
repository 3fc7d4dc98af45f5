#include "skeleton/actors/actor_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

std::unique_ptr<ActorSequence> make(const ActorTake& take) {
    auto sequence = ActorSequence::create(take);
    EXPECT_TRUE(sequence) << sequence.error().to_string();
    return std::move(*sequence);
}

bool same(const ActorFrame& a, const ActorFrame& b) {
    if (a.time != b.time || a.truth.bodies.size() != b.truth.bodies.size()) return false;
    for (std::size_t i = 0; i < a.truth.bodies.size(); ++i) {
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition &p = a.truth.bodies[i].joints[j], &q = b.truth.bodies[i].joints[j];
            if (p.position_m != q.position_m || p.state != q.state) return false;
        }
    }
    return a.depth_m == b.depth_m && a.part == b.part && a.actor == b.actor;
}

TEST(ActorSequence, RefusesWhatItCannotPlay) {
    EXPECT_FALSE(ActorSequence::create({.motion = "levitate"}));
    EXPECT_FALSE(ActorSequence::create({.motion = "log:tests/data/motion/none.csv"}));
    EXPECT_FALSE(ActorSequence::create({.actors = 0}));
    EXPECT_FALSE(ActorSequence::create({.actors = 7}));
    EXPECT_FALSE(ActorSequence::create({.width = 321}));
    EXPECT_FALSE(ActorSequence::create({.distance_m = NAN}));
    EXPECT_FALSE(ActorSequence::create({.lead_in_s = -1}));
    EXPECT_NE(ActorSequence::create({.motion = "levitate"}).error().hint.find("dance"),
              std::string::npos);
}

TEST(ActorSequence, FramesDependOnTheirIndexAlone) {
    const ActorTake take{.seed = 4, .motion = "wander", .actors = 2};
    const auto one = make(take), two = make(take);
    ActorFrame a, b;
    one->render(200, a);
    one->render(17, a);
    two->render(17, b);
    EXPECT_TRUE(same(a, b));
    const auto other = make({.seed = 5, .motion = "wander", .actors = 2});
    other->render(17, b);
    EXPECT_FALSE(same(a, b));
}

class Motions : public testing::TestWithParam<std::string> {};

// Laws of every take: bones keep their lengths, joints move as fast as people do, tracked joints
// lie behind flesh of their own, labels and people go together.
TEST_P(Motions, AreTakesOfPeople) {
    const auto sequence = make({.seed = 6, .motion = GetParam()});
    ASSERT_GT(sequence->frames(), 0);
    EXPECT_EQ(sequence->rate_hz(), 30);
    const CameraModel& camera = sequence->rig().depth;
    ActorFrame frame;
    std::array<double, kJointCount> length{};
    int tracked = 0, joints = 0;
    const int step = std::max(1, sequence->frames() / 12);
    for (int i = 0; i < sequence->frames(); i += step) {
        sequence->render(i, frame);
        EXPECT_EQ(frame.time, static_cast<TimeNs>(std::llround(i * 1e9 / 30)));
        for (std::size_t k = 0; k < frame.part.size(); ++k) {
            ASSERT_EQ(frame.part.pixels()[k] == 255, frame.actor.pixels()[k] == 0);
        }
        if (frame.truth.bodies.empty()) continue;
        ASSERT_EQ(frame.truth.bodies.size(), 1u);
        const Body& body = frame.truth.bodies[0];
        EXPECT_EQ(body.id, 1u);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& p = body.joints[j];
            ++joints;
            if (p.state == JointState::tracked) {
                ++tracked;
                const auto x = static_cast<int>(
                    std::lround(camera.fx * double(p.position_m.x / p.position_m.z) + camera.cx));
                const auto y = static_cast<int>(
                    std::lround(camera.fy * double(p.position_m.y / p.position_m.z) + camera.cy));
                ASSERT_TRUE(frame.actor.contains(x, y));
            }
            // Shoulders are lifted and trunks bend; limbs keep their length.
            const bool limb = j >= 5 && j % 4 != 0;
            if (!limb) continue;
            const auto parent = static_cast<std::size_t>(kJointParent[j]);
            const double now = double(glm::distance(p.position_m, body.joints[parent].position_m));
            if (length[j] == 0) length[j] = now;
            EXPECT_NEAR(now, length[j], 1e-3) << joint_name(static_cast<Joint>(j));
        }
    }
    // Seen from the side, the trunk hides an arm and often a leg: a third of the joints.
    const bool side_on = GetParam() == "sideways" || GetParam() == "lie" || GetParam() == "cross";
    EXPECT_GT(tracked, (side_on ? 0.45 : 0.55) * joints);
}

INSTANTIATE_TEST_SUITE_P(All, Motions, testing::ValuesIn(actor_motions()));
INSTANTIATE_TEST_SUITE_P(Logs, Motions,
                         testing::Values("log:tests/data/motion/laban-wave.csv",
                                         "log:tests/data/motion/laban-draw.csv",
                                         "log:tests/data/motion/laban-point.csv",
                                         "log:tests/data/motion/laban-arms.csv",
                                         "log:tests/data/motion/keraal-ctk.csv",
                                         "log:tests/data/motion/multitrack-4-2.csv",
                                         "log:tests/data/motion/multitrack-4-3.csv",
                                         "log:tests/data/motion/multitrack-24-0.csv",
                                         "log:tests/data/motion/multitrack-24-1.csv"));

TEST(ActorSequence, PartnersMeet) {
    ActorFrame frame;
    for (const std::string name : {"cross", "hug"}) {
        const auto sequence = make({.seed = 2, .motion = name, .actors = 2, .furniture = false});
        float nearest = 9, farthest = 0;
        for (int i = 0; i < 300; i += 6) {
            sequence->render(i, frame);
            if (frame.truth.bodies.size() < 2) continue;
            const glm::vec3 a = frame.truth.bodies[0][Joint::spine].position_m,
                            b = frame.truth.bodies[1][Joint::spine].position_m;
            nearest = std::min(nearest, std::abs(a.x - b.x));
            farthest = std::max(farthest, std::abs(a.x - b.x));
        }
        EXPECT_LT(nearest, name == "hug" ? 0.5f : 0.2f) << name;
        EXPECT_GT(farthest, 1.2f) << name;
    }
}

TEST(ActorSequence, SomebodyEntersAndLeaves) {
    const auto sequence = make({.seed = 2, .motion = "enter"});
    ActorFrame frame;
    for (const auto& [index, people] : {std::pair(0, 0), std::pair(150, 1), std::pair(299, 0)}) {
        sequence->render(index, frame);
        EXPECT_EQ(frame.truth.bodies.size(), static_cast<std::size_t>(people)) << index;
    }
}

TEST(ActorSequence, ShowsTheEmptyRoomFirst) {
    const ActorTake take{.seed = 9, .motion = "arms", .lead_in_s = 1};
    const auto sequence = make(take);
    ActorTake without = take;
    without.lead_in_s = 0;
    EXPECT_EQ(sequence->frames(), make(without)->frames() + 30);
    ActorFrame frame;
    sequence->render(29, frame);
    EXPECT_TRUE(frame.truth.bodies.empty());
    EXPECT_EQ(std::count(frame.actor.pixels().begin(), frame.actor.pixels().end(), 0),
              static_cast<std::ptrdiff_t>(frame.actor.size()));
    sequence->render(30, frame);
    EXPECT_EQ(frame.truth.bodies.size(), 1u);
}

TEST(ActorSequence, StandsWhereItWasAsked) {
    ActorFrame frame;
    for (const double distance : {1.2, 2.5, 4.0}) {
        make({.seed = 2, .motion = "idle", .distance_m = distance})->render(0, frame);
        ASSERT_EQ(frame.truth.bodies.size(), 1u);
        // Along the floor; the camera is tilted a little.
        const glm::vec3 hip = frame.truth.bodies[0][Joint::hip_center].position_m;
        EXPECT_NEAR(double(hip.z), distance, 0.25 * distance);
    }
}

TEST(ActorSequence, PlaysSeveralPeopleWithTheirOwnNumbers) {
    ActorFrame frame;
    make({.seed = 12, .motion = "idle", .actors = 3, .distance_m = 3.2})->render(0, frame);
    ASSERT_GE(frame.truth.bodies.size(), 2u);
    for (std::size_t i = 1; i < frame.truth.bodies.size(); ++i) {
        EXPECT_GT(frame.truth.bodies[i].id, frame.truth.bodies[i - 1].id);
    }
    for (const Body& body : frame.truth.bodies) {
        const auto n =
            std::count(frame.actor.pixels().begin(), frame.actor.pixels().end(), body.id);
        EXPECT_GT(n, 0);
    }
}

}  // namespace
}  // namespace kino
