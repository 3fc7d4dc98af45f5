#include "skeleton/motion/joint_layouts.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <string>

#include "skeleton/synthetic/body_model.h"
#include "tests/support/random.h"

namespace kino::test {
namespace {

Body random_body(std::uint64_t seed) {
    Random random(seed);
    Body body;
    body.id = static_cast<std::uint32_t>(seed);
    for (JointPosition& p : body.joints) {
        for (int a = 0; a < 3; ++a) p.position_m[a] = static_cast<float>(random.real(-2, 2));
        p.state = static_cast<JointState>(random.integer(0, 2));
        p.confidence = static_cast<float>(random.real(0, 1));
    }
    return body;
}

Body standing_body() {
    const auto places = pose_body(standing_pose()).joint_m;
    Body body;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        body.joints[j] = {glm::vec3(places[j]), JointState::tracked, 0.8F};
    }
    return body;
}

void expect_same(const Body& a, const Body& b) {
    EXPECT_EQ(a.id, b.id);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_EQ(a.joints[j].position_m, b.joints[j].position_m);
        EXPECT_EQ(a.joints[j].state, b.joints[j].state);
        EXPECT_EQ(a.joints[j].confidence, b.joints[j].confidence);
    }
}

const JointPosition& at(const Joints25& joints, Joint25 j) {
    return joints[static_cast<std::size_t>(j)];
}
const JointPosition& at(const Joints32& joints, Joint32 j) {
    return joints[static_cast<std::size_t>(j)];
}

TEST(JointLayouts, TheTwentyComeBackUnchanged) {
    for (std::uint64_t seed = 1; seed < 50; ++seed) {
        const Body body = random_body(seed);
        expect_same(from_joints25(to_joints25(body), body.id), body);
        expect_same(from_joints32(to_joints32(body), body.id), body);
    }
}

/// "ElbowLeft" and "ELBOW_LEFT" are elbow_left.
std::string plain(std::string name) {
    std::string out;
    for (const char c : name) {
        if (c != '_') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return out;
}

TEST(JointLayouts, JointsOfOneNameAreOneJoint) {
    const Body body = random_body(4);
    const Joints25 v2 = to_joints25(body);
    const Joints32 azure = to_joints32(body);
    int same25 = 0, same32 = 0;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const std::string name = plain(joint_name(static_cast<Joint>(j)));
        for (std::size_t k = 0; k < kJoint25Count; ++k) {
            if (plain(joint_name(static_cast<Joint25>(k))) != name) continue;
            ++same25;
            EXPECT_EQ(v2[k].position_m, body.joints[j].position_m) << name;
        }
        for (std::size_t k = 0; k < kJoint32Count; ++k) {
            if (plain(joint_name(static_cast<Joint32>(k))) != name) continue;
            ++same32;
            EXPECT_EQ(azure[k].position_m, body.joints[j].position_m) << name;
        }
    }
    EXPECT_EQ(same25, 17);  // head and all limbs
    EXPECT_EQ(same32, 17);
}

TEST(JointLayouts, NumbersAreTheSdks) {
    EXPECT_STREQ(joint_name(static_cast<Joint25>(20)), "SpineShoulder");
    EXPECT_STREQ(joint_name(static_cast<Joint25>(24)), "ThumbRight");
    EXPECT_STREQ(joint_name(static_cast<Joint32>(4)), "CLAVICLE_LEFT");
    EXPECT_STREQ(joint_name(static_cast<Joint32>(11)), "CLAVICLE_RIGHT");
    EXPECT_STREQ(joint_name(static_cast<Joint32>(18)), "HIP_LEFT");
    EXPECT_STREQ(joint_name(static_cast<Joint32>(26)), "HEAD");
    EXPECT_STREQ(joint_name(static_cast<Joint32>(31)), "EAR_RIGHT");
    EXPECT_EQ(k4abt_confidence(JointState::lost), 0);
    EXPECT_EQ(k4abt_confidence(JointState::inferred), 1);
    EXPECT_EQ(k4abt_confidence(JointState::tracked), 2);
}

TEST(JointLayouts, WhatIsMadeUpLiesWhereItShould) {
    const Body body = standing_body();  // faces +z, its left is +x, up is +y
    const Joints32 j = to_joints32(body);
    const glm::vec3 head = body[Joint::head].position_m;
    EXPECT_GT(at(j, Joint32::nose).position_m.z, head.z + 0.09F);
    EXPECT_GT(at(j, Joint32::eye_left).position_m.x,
              at(j, Joint32::eye_right).position_m.x + 0.06F);
    // The neck leans forward, and the face with it.
    const glm::vec3 up = glm::normalize(head - body[Joint::shoulder_center].position_m);
    EXPECT_NEAR(glm::dot(at(j, Joint32::eye_left).position_m - head, up), 0.03F, 1e-3F);
    EXPECT_GT(at(j, Joint32::ear_left).position_m.x, head.x + 0.07F);
    EXPECT_GT(at(j, Joint32::clavicle_left).position_m.x, 0.03F);
    EXPECT_LT(at(j, Joint32::clavicle_right).position_m.x, -0.03F);
    EXPECT_LT(at(j, Joint32::spine_chest).position_m.y, at(j, Joint32::neck).position_m.y);
    EXPECT_GT(at(j, Joint32::spine_chest).position_m.y, at(j, Joint32::spine_navel).position_m.y);
    const Joints25 v2 = to_joints25(body);
    EXPECT_GT(at(v2, Joint25::neck).position_m.y, at(v2, Joint25::spine_shoulder).position_m.y);
    EXPECT_LT(at(v2, Joint25::neck).position_m.y, at(v2, Joint25::head).position_m.y);
    const glm::vec3 hand = at(v2, Joint25::hand_left).position_m;
    EXPECT_LT(glm::length(at(v2, Joint25::hand_tip_left).position_m - hand -
                          (hand - at(v2, Joint25::wrist_left).position_m)),
              1e-6F);
}

TEST(JointLayouts, WhatIsMadeUpIsNeverSurerThanItsSources) {
    Body body = standing_body();
    EXPECT_EQ(at(to_joints25(body), Joint25::neck).state, JointState::inferred);
    EXPECT_FLOAT_EQ(at(to_joints25(body), Joint25::neck).confidence, 0.4F);
    EXPECT_EQ(at(to_joints25(body), Joint25::thumb_left).state, JointState::lost);
    body[Joint::head].state = JointState::lost;
    EXPECT_EQ(at(to_joints25(body), Joint25::neck).state, JointState::lost);
    EXPECT_EQ(at(to_joints32(body), Joint32::nose).state, JointState::lost);
    EXPECT_EQ(at(to_joints32(body), Joint32::nose).confidence, 0);
    EXPECT_EQ(at(to_joints32(body), Joint32::spine_chest).state, JointState::inferred);
    // No plane to look out of: a body that is one point.
    for (const JointPosition& p : to_joints32(Body{})) {
        EXPECT_EQ(p.state, JointState::lost);
        EXPECT_EQ(p.position_m, glm::vec3(0));
    }
}

}  // namespace
}  // namespace kino::test
