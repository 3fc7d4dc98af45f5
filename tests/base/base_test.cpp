#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <thread>

#include "base/bounded_queue.h"
#include "base/camera_model.h"
#include "base/frame.h"
#include "base/mailbox.h"

namespace kino {
namespace {

Pose random_pose(std::mt19937& random) {
    std::normal_distribution<double> n;
    return {glm::normalize(glm::dquat(n(random), n(random), n(random), n(random))),
            {n(random), n(random), n(random)}};
}

TEST(Pose, InverseAndCompositionAreAGroup) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        const Pose a_from_b = random_pose(random);
        const Pose b_from_c = random_pose(random);
        const glm::dvec3 p(0.3, -2.0, 5.0);
        EXPECT_LT(glm::length((a_from_b * b_from_c) * p - a_from_b * (b_from_c * p)), 1e-12);
        EXPECT_LT(glm::length((inverse(a_from_b) * a_from_b) * p - p), 1e-12);
        EXPECT_LT(glm::length(glm::dvec3(a_from_b.matrix() * glm::dvec4(p, 1)) - a_from_b * p),
                  1e-12);
    }
}

TEST(Pose, LongChainStaysARotation) {
    std::mt19937 random(2);
    const Pose step = random_pose(random);
    Pose chain;
    for (int i = 0; i < 100'000; ++i) chain = chain * Pose{step.rotation, {}};
    EXPECT_TRUE(is_valid(chain));
}

TEST(Pose, WorldFromCameraAxesIsTheLiteralDiagonal) {
    const glm::dvec3 p = world_from_camera_axes() * glm::dvec3(1, 2, 3);
    EXPECT_EQ(p, glm::dvec3(1, -2, -3));
}

TEST(Pose, InterpolationMeetsItsEnds) {
    std::mt19937 random(3);
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    EXPECT_LT(glm::length(interpolate(a, b, 1) * glm::dvec3(1, 2, 3) - b * glm::dvec3(1, 2, 3)),
              1e-12);
    EXPECT_LT(glm::length(interpolate(a, b, 0) * glm::dvec3(1, 2, 3) - a * glm::dvec3(1, 2, 3)),
              1e-12);
}

TEST(RigParameters, RefusesWhatCannotWork) {
    EXPECT_TRUE(validate(default_kinect1_rig()));
    RigParameters rig = default_kinect1_rig();
    rig.depth.fx = 0;
    ASSERT_FALSE(validate(rig));
    EXPECT_EQ(validate(rig).error().where, "depth camera");
    rig = default_kinect1_rig();
    rig.color->k2 = std::numeric_limits<double>::quiet_NaN();
    ASSERT_FALSE(validate(rig));
    EXPECT_NE(validate(rig).error().what.find("k2"), std::string::npos);
    rig = default_kinect1_rig();
    rig.color_from_depth.rotation = {0, 0, 0, 0};
    EXPECT_FALSE(validate(rig));
    rig = default_kinect1_rig();
    rig.max_depth_m = rig.min_depth_m;
    EXPECT_FALSE(validate(rig));
    rig = default_kinect1_rig();
    rig.depth.width = 1 << 30;
    EXPECT_FALSE(validate(rig));
}

TEST(Mailbox, NewestWinsAndDropsAreCounted) {
    Mailbox<int> box;
    box.put(1);
    box.put(2);
    EXPECT_EQ(box.take(), 2);
    EXPECT_EQ(box.take(), std::nullopt);
    EXPECT_EQ(box.dropped(), 1);
    box.close();
    EXPECT_EQ(box.wait(kNsPerSecond * 100), std::nullopt);
}

TEST(BoundedQueue, KeepsOrderAndLosesNothingAcrossThreads) {
    BoundedQueue<int> queue(3);
    std::thread writer([&] {
        for (int i = 0; i < 1000; ++i) EXPECT_TRUE(queue.push(i));
        queue.close();
    });
    int expected = 0;
    while (const auto value = queue.pop()) EXPECT_EQ(*value, expected++);
    writer.join();
    EXPECT_EQ(expected, 1000);
}

TEST(BoundedQueue, FullQueueRefusesAndKeepsTheValue) {
    BoundedQueue<std::string> queue(1);
    std::string a = "a";
    std::string b = "b";
    EXPECT_TRUE(queue.try_push(a));
    EXPECT_FALSE(queue.try_push(b));
    EXPECT_EQ(b, "b");
}

TEST(Joints, EveryParentComesBeforeItsChild) {
    for (std::size_t i = 1; i < kJointCount; ++i) {
        EXPECT_LT(static_cast<std::size_t>(kJointParent[i]), i) << joint_name(Joint(i));
    }
}

}  // namespace
}  // namespace kino
