#include "skeleton/actors/actor_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <map>

#include "skeleton/actors/actor_pose.h"
#include "skeleton/actors/pose_draw.h"
#include "tests/skeleton/actors/mesh_reference.h"

namespace kino {
namespace {

TEST(BaseMesh, IsItsOwnMirrorWithItsWeights) {
    const BaseMesh& mesh = base_mesh();
    ASSERT_EQ(mesh.vertex_m.size(), 13380u);
    const auto other = [](std::size_t bone) {
        const std::size_t first = bone_index(ActorBone::clavicle);
        if (bone < first) return bone;
        return bone < first + kActorBonesOfSide ? bone + kActorBonesOfSide
                                                : bone - kActorBonesOfSide;
    };
    for (std::size_t i = 0; i < mesh.vertex_m.size(); ++i) {
        const std::size_t m = mesh.mirror[i];
        ASSERT_EQ(mesh.mirror[m], i);
        float sum = 0;
        std::map<std::size_t, float> here, there;
        for (std::size_t k = 0; k < 4; ++k) {
            sum += mesh.weights[i].weight[k];
            here[other(mesh.weights[i].bone[k])] += mesh.weights[i].weight[k];
            there[mesh.weights[m].bone[k]] += mesh.weights[m].weight[k];
        }
        ASSERT_NEAR(sum, 1, 1e-6);
        // On the midline the weights of left and right were painted by hand.
        if (std::abs(mesh.vertex_m[i].x) < 0.02) continue;
        for (const auto& [bone, weight] : here) ASSERT_NEAR(weight, there[bone], 0.08) << i;
    }
}

// A triangle and the one of the mirrored corners: the labels change sides and nothing else. Quads
// are cut along one of two diagonals, so a few triangles have no twin.
TEST(BaseMesh, PartsAreMirrored) {
    const BaseMesh& mesh = base_mesh();
    const auto& parts = base_mesh_parts();
    std::map<std::array<std::uint32_t, 3>, BodyPart> by_corners;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        auto t = mesh.triangles[i];
        std::sort(t.begin(), t.end());
        by_corners[t] = parts[i];
    }
    int twins = 0, agree = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        std::array<std::uint32_t, 3> t{};
        for (std::size_t k = 0; k < 3; ++k) t[k] = mesh.mirror[mesh.triangles[i][k]];
        std::sort(t.begin(), t.end());
        const auto found = by_corners.find(t);
        if (found == by_corners.end()) continue;
        ++twins;
        agree += found->second == mirrored(parts[i]);
    }
    EXPECT_GT(twins, 10000);
    EXPECT_GE(agree, twins - twins / 500);
}

TEST(BaseMesh, EveryPartHasItsPlace) {
    const BaseMesh& mesh = base_mesh();
    const auto& parts = base_mesh_parts();
    std::array<glm::dvec3, kBodyPartCount> middle{};
    std::array<int, kBodyPartCount> count{};
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (const std::uint32_t v : mesh.triangles[i]) {
            middle[static_cast<std::size_t>(parts[i])] += mesh.vertex_m[v];
            ++count[static_cast<std::size_t>(parts[i])];
        }
    }
    const auto at = [&](BodyPart p) {
        const auto i = static_cast<std::size_t>(p);
        return middle[i] / static_cast<double>(count[i]);
    };
    using enum BodyPart;
    for (const int n : count) EXPECT_GT(n, 150);
    const BodyPart down[] = {
        head,           neck,           chest_left,    belly_left, thigh_left_high,
        thigh_left_low, shin_left_high, shin_left_low, foot_left};
    for (std::size_t i = 1; i < std::size(down); ++i)
        EXPECT_LT(at(down[i]).y, at(down[i - 1]).y) << i;
    const BodyPart out[] = {chest_left,        upper_arm_left_high, upper_arm_left_low,
                            forearm_left_high, forearm_left_low,    hand_left};
    for (std::size_t i = 1; i < std::size(out); ++i) EXPECT_GT(at(out[i]).x, at(out[i - 1]).x) << i;
    EXPECT_LT(at(chest_right).x, 0);
}

class Looks : public testing::TestWithParam<int> {};

TEST_P(Looks, StandAsTallAsTheySayOnTheFloor) {
    const ActorLook look = random_look(static_cast<std::uint64_t>(GetParam()));
    EXPECT_GE(look.stature_m, 1.1);
    EXPECT_LE(look.stature_m, 2.0);
    const ActorBody body = make_actor_body(look);
    std::vector<glm::vec3> posed;
    const PosedBones bones = pose_actor(body, actor_pose(pose_body(standing_pose())), posed);
    double low = 1e9, high = -1e9, left = 1e9, right = 1e9;
    for (const glm::vec3& p : posed) {
        low = std::min(low, double(p.y));
        high = std::max(high, double(p.y));
    }
    for (std::size_t i = 0; i < body.first_two_sided; ++i) {
        for (const std::uint32_t v : body.triangles[i]) {
            if (body.part[i] == BodyPart::foot_left) left = std::min(left, double(posed[v].y));
            if (body.part[i] == BodyPart::foot_right) right = std::min(right, double(posed[v].y));
        }
    }
    EXPECT_NEAR(low, 0, 1e-5);
    EXPECT_LT(left, 0.03);
    EXPECT_LT(right, 0.03);
    // Hair, soles and straight legs add a little, a bent neck takes some.
    EXPECT_NEAR(high, look.stature_m, 0.10);
    EXPECT_GT(bones.joint_m[static_cast<std::size_t>(Joint::shoulder_left)].x,
              bones.joint_m[static_cast<std::size_t>(Joint::shoulder_right)].x);
}

// Joints are truth: they must be in the flesh, whoever stands how.
TEST_P(Looks, HaveTheirJointsInTheFlesh) {
    ActorRandom random{static_cast<std::uint64_t>(GetParam()), 3};
    ActorLook look = random_look(random.bits());
    const ActorBody body = make_actor_body(look);
    const DrawnPose drawn = draw_pose(random);
    std::vector<glm::vec3> posed;
    const PosedBones bones = pose_actor(body, drawn.pose, posed);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const double winding = test::winding_number(body, posed, bones.joint_m[j]);
        // A bent joint may come out of its fold by a little.
        const double outside = winding > 0.5 ? 0 : test::distance_to_mesh(posed, bones.joint_m[j]);
        EXPECT_LT(outside, 0.025) << joint_name(static_cast<Joint>(j));
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Looks, testing::Range(0, 24));

TEST(ActorBody, SkirtsMoveWithTheLegs) {
    ActorLook look;
    look.skirt_end = 1.5;
    look.skirt_flare_m = 0.1;
    const ActorBody body = make_actor_body(look);
    ASSERT_GT(body.triangles.size(), body.first_two_sided);
    for (const BoneWeights& w : body.weights) {
        float sum = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            sum += w.weight[k];
            if (k > 0) {
                ASSERT_TRUE(w.weight[k] == 0 || w.weight[k - 1] > 0);
            }
        }
        ASSERT_NEAR(sum, 1, 1e-5);
    }
    // No point of it strays from the body, sitting or standing.
    ActorRandom random{1};
    for (int i = 0; i < 10; ++i) {
        std::vector<glm::vec3> posed;
        const PosedBones bones = pose_actor(body, draw_pose(random).pose, posed);
        for (const glm::vec3& p : posed) {
            ASSERT_LT(glm::distance(glm::dvec3(p), bones.joint_m[0]), 1.6);
        }
    }
}

}  // namespace
}  // namespace kino
