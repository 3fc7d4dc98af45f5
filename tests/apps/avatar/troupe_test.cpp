#include <cstring>
#include <limits>
#include <random>
#include <set>

#include "posed.h"

namespace kino::test {
namespace {

constexpr double kFrameS = 1.0 / 30;

/// `count` people side by side, all moving.
BodyFrame crowd(int count, double t_s, double apart_m = 0.9) {
    BodyFrame frame;
    for (int i = 0; i < count; ++i) {
        const Motion motion = all_motions()[static_cast<std::size_t>(i) % all_motions().size()];
        frame.bodies.push_back(body_of(person_at(motion, t_s, {apart_m * i - 2, 0, -3}),
                                       static_cast<std::uint32_t>(i + 1)));
    }
    return frame;
}

bool same_nodes(const Scene& a, const Scene& b) {
    if (a.meshes.size() != b.meshes.size()) return false;
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
        const MeshNode& x = a.meshes[i];
        const MeshNode& y = b.meshes[i];
        if (x.id != y.id || x.material != y.material || x.mesh != y.mesh || x.skin != y.skin ||
            std::memcmp(&x.world_from_object, &y.world_from_object, sizeof(x.world_from_object)) !=
                0 ||
            std::memcmp(&x.previous_world_from_object, &y.previous_world_from_object,
                        sizeof(x.world_from_object)) != 0 ||
            x.pose->size() != y.pose->size() ||
            std::memcmp(x.pose->data(), y.pose->data(), x.pose->size() * sizeof(glm::mat4)) != 0) {
            return false;
        }
    }
    return true;
}

class Troupe : public ::testing::Test {
  protected:
    static std::shared_ptr<const AvatarRig> rig() {
        static const auto opened = rig_called("mannequin");
        return opened;
    }
};

TEST_F(Troupe, NobodyShownAppendsNothing) {
    AvatarTroupe troupe(rig(), {.idle = false});
    Scene scene;
    scene.materials.resize(2);
    troupe.fill(scene, 10);
    for (int i = 0; i < 60; ++i) {
        AvatarMoment nobody;
        nobody.dt_s = 0.1;
        troupe.step(nobody);
        troupe.fill(scene, 10);
    }
    EXPECT_EQ(troupe.shown(), 0u);
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_EQ(scene.materials.size(), 2u);
}

TEST_F(Troupe, SixPeopleAtOnceAndNoSeventh) {
    AvatarTroupe troupe(rig(), {});
    for (int i = 0; i < 30; ++i) {
        const BodyFrame frame = crowd(7, i * kFrameS);
        troupe.step(moment_of(frame, kFrameS));
        ASSERT_EQ(troupe.shown(), AvatarTroupe::kPlaces);
        const Scene scene = filled(troupe, 100);
        ASSERT_EQ(scene.meshes.size(), 6 * rig()->parts.size());
        ASSERT_EQ(scene.materials.size(), rig()->materials.size());
        std::set<std::uint32_t> ids;
        for (const MeshNode& node : scene.meshes) {
            ids.insert(node.id);
            EXPECT_GE(node.id, 100u);
            EXPECT_LT(node.id, 100 + 6 * rig()->parts.size());
            EXPECT_GE(node.material, 1u);
            EXPECT_LE(node.material, scene.materials.size());
        }
        EXPECT_EQ(ids.size(), scene.meshes.size());
        expect_sane(scene);
    }
}

TEST_F(Troupe, TheSameMomentsGiveTheSameBits) {
    AvatarTroupe a(rig(), {});
    AvatarTroupe b(rig(), {});
    std::vector<Scene> first;
    for (int round = 0; round < 2; ++round) {
        for (int i = 0; i < 90; ++i) {
            // People come and go, and the idle one between them.
            BodyFrame frame = crowd(i % 40 < 20 ? i % 5 : 0, i * kFrameS);
            AvatarMoment moment = moment_of(frame, 0.05);
            moment.floor_y_m = 0;
            a.step(moment);
            const Scene now = filled(a);
            if (round == 0) {
                b.step(moment);
                ASSERT_TRUE(same_nodes(now, filled(b))) << i;
                first.push_back(now);
            } else {
                ASSERT_TRUE(same_nodes(now, first[static_cast<std::size_t>(i)])) << i;
            }
        }
        a.reset();
        EXPECT_EQ(a.shown(), 0u);
    }
}

TEST_F(Troupe, APersonWhoLeavesMidGestureFadesAndIsGone) {
    AvatarTroupe troupe(rig(), {.hand_over_s = 0.6, .idle = false});
    glm::dmat4 before(0);
    for (int i = 0; i < 60; ++i) {
        const BodyFrame frame = crowd(i < 30 ? 1 : 0, 3 + i * kFrameS);
        troupe.step(moment_of(frame, kFrameS));
        const Scene scene = filled(troupe);
        expect_sane(scene);
        if (i == 29) before = scene.meshes.at(0).world_from_object;
        if (i >= 30 && i < 45) {
            ASSERT_EQ(troupe.shown(), 1u) << i;
            // It only gets smaller, and stays where it was.
            const glm::dmat4& now = scene.meshes.at(0).world_from_object;
            EXPECT_LE(now[0][0], before[0][0]);
            EXPECT_NEAR(now[3].x, before[3].x, 0.1);
            EXPECT_LT(scene.materials.at(0).opacity, 1.01f);
            EXPECT_GE(scene.materials.at(0).opacity, 1.0f);  // no blended pass
        }
        if (i >= 49) {
            EXPECT_EQ(troupe.shown(), 0u) << i;
        }
    }
}

TEST_F(Troupe, OneWhoComesBackUnderAnotherNameGoesOnAsTheSame) {
    AvatarTroupe troupe(rig(), {.idle = false});
    std::uint32_t id = 0;
    glm::dvec3 hand(0);
    for (int i = 0; i < 80; ++i) {
        BodyFrame frame = crowd(1, 3 + 0.2 * kFrameS * i);
        frame.bodies[0].id = i < 40 ? 5 : 9;
        if (i >= 30 && i < 40) frame.bodies.clear();
        troupe.step(moment_of(frame, kFrameS));
        ASSERT_EQ(troupe.shown(), 1u) << i;
        const Scene scene = filled(troupe);
        const glm::dvec3 now = *posed_joint(*rig(), scene.meshes.at(0), Joint::hand_right);
        if (i == 20) id = scene.meshes[0].id;
        if (i > 20) {
            EXPECT_EQ(scene.meshes[0].id, id);
            EXPECT_LT(glm::length(now - hand), 0.25) << i;
        }
        hand = now;
    }
}

TEST_F(Troupe, PeopleWhoseIdentitiesSwapKeepTheirAvatars) {
    AvatarTroupe troupe(rig(), {.idle = false});
    std::array<double, 2> x{};
    for (int i = 0; i < 60; ++i) {
        // Within arm's reach of each other, where a name alone would be believed.
        BodyFrame frame = crowd(2, i * kFrameS, 0.5);
        if (i % 2 == 1) std::swap(frame.bodies[0].id, frame.bodies[1].id);
        troupe.step(moment_of(frame, kFrameS));
        ASSERT_EQ(troupe.shown(), 2u);
        const Scene scene = filled(troupe);
        for (std::size_t p = 0; p < 2; ++p) {
            const MeshNode& node = scene.meshes[p * rig()->parts.size()];
            if (i > 0) {
                EXPECT_LT(std::abs(node.world_from_object[3].x - x[p]), 0.1) << i;
            }
            x[p] = node.world_from_object[3].x;
        }
    }
}

// The same name three metres away is somebody else: nobody flies through the room.
TEST_F(Troupe, ATeleportedNameIsANewPerson) {
    AvatarTroupe troupe(rig(), {.idle = false});
    for (int i = 0; i < 20; ++i) {
        BodyFrame frame = crowd(1, i * kFrameS);
        if (i >= 10) {
            for (auto& joint : frame.bodies[0].joints) joint.position_m.x += 3;
        }
        troupe.step(moment_of(frame, kFrameS));
        if (i >= 10) {
            EXPECT_EQ(troupe.shown(), 2u);
        }
        for (const MeshNode& node : filled(troupe).meshes) {
            const double x = node.world_from_object[3].x;
            EXPECT_TRUE(std::abs(x + 2) < 0.3 || std::abs(x - 1) < 0.3) << x;
        }
    }
}

TEST_F(Troupe, WhateverJointsAreTheSceneIsFinite) {
    std::mt19937_64 random(11);
    std::uniform_int_distribution<int> dice(0, 9);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    AvatarTroupe troupe(rig(), {});
    for (int i = 0; i < 400; ++i) {
        BodyFrame frame = crowd(3, i * kFrameS);
        for (Body& body : frame.bodies) {
            for (JointPosition& joint : body.joints) {
                switch (dice(random)) {
                    case 0:
                        joint.position_m.x = nan;
                        break;
                    case 1:
                        joint.position_m = glm::vec3(inf, -inf, 0);
                        break;
                    case 2:
                        joint.position_m *= 1e30f;
                        break;
                    case 3:
                        joint.state = JointState::lost;
                        break;
                    case 4:
                        joint.position_m = body.joints[0].position_m;
                        break;
                    default:
                        break;
                }
            }
        }
        AvatarMoment moment = moment_of(frame, i % 7 == 0 ? std::nan("") : (i % 5 == 0 ? -1 : 10));
        if (i % 3 == 0) moment.floor_y_m = 0;
        if (i % 50 == 0) moment.world_from_depth.translation.x = std::nan("");
        if (i % 11 == 0) moment.facing = {0, 1, 0};
        troupe.step(moment);
        const Scene scene = filled(troupe);
        expect_sane(scene, 20);
        if (HasFatalFailure()) return;
    }
}

TEST_F(Troupe, TheIdleOneComesWhenNobodyIsThereAndGoesWhenSomebodyIs) {
    AvatarTroupe troupe(rig(), {.idle = true, .idle_after_s = 1});
    AvatarMoment nobody;
    nobody.dt_s = 0.1;
    nobody.middle_m = {1, 0.25, -2};
    nobody.facing = {1, 0, 0};
    nobody.floor_y_m = 0.25;
    for (int i = 0; i < 9; ++i) troupe.step(nobody);
    EXPECT_FALSE(troupe.idling());
    for (int i = 0; i < 10; ++i) troupe.step(nobody);
    EXPECT_TRUE(troupe.idling());
    ASSERT_EQ(troupe.shown(), 1u);
    const Scene scene = filled(troupe);
    const auto at = [&](Joint j) { return *posed_joint(*rig(), scene.meshes[0], j); };
    EXPECT_LT(glm::length(at(Joint::hip_center) - glm::dvec3(1, 1.2, -2)), 0.15);
    // Facing +x, its left is -z; its feet point ahead.
    EXPECT_LT(at(Joint::shoulder_left).z, at(Joint::shoulder_right).z - 0.2);
    EXPECT_GT(at(Joint::foot_left).x, at(Joint::ankle_left).x);
    // It moves.
    for (int i = 0; i < 10; ++i) troupe.step(nobody);
    EXPECT_FALSE(same_nodes(scene, filled(troupe)));
    const BodyFrame frame = crowd(1, 0);
    AvatarMoment somebody = nobody;
    somebody.bodies = &frame;
    troupe.step(somebody);
    EXPECT_FALSE(troupe.idling());
    EXPECT_EQ(troupe.shown(), 2u);
    for (int i = 0; i < 8; ++i) troupe.step(somebody);
    EXPECT_EQ(troupe.shown(), 1u);
}

TEST_F(Troupe, AMirrorImageRaisesTheOtherArmAndStandsAcross) {
    AvatarTroupe troupe(rig(), {.mirror = true, .idle = false});
    PosedBody person = person_at(Motion::tpose, 0, {0.4, 0, -2});
    // The left arm goes up.
    const glm::dvec3 shoulder = person[Joint::shoulder_left];
    for (const auto& [joint, up] :
         {std::pair{Joint::elbow_left, 0.285}, std::pair{Joint::wrist_left, 0.535},
          std::pair{Joint::hand_left, 0.62}}) {
        person.joint_m[index_of(joint)] = shoulder + glm::dvec3(0.02, up, 0);
    }
    BodyFrame frame;
    frame.bodies = {body_of(person)};
    AvatarMoment moment = moment_of(frame, 0.1);
    moment.middle_m = {0.1, 0, -2};
    for (int i = 0; i < 5; ++i) troupe.step(moment);
    const Scene scene = filled(troupe);
    const auto at = [&](Joint j) { return *posed_joint(*rig(), scene.meshes.at(0), j); };
    EXPECT_GT(at(Joint::hand_right).y, at(Joint::head).y);
    EXPECT_LT(at(Joint::hand_left).y, at(Joint::head).y);
    EXPECT_GT(at(Joint::shoulder_left).x, at(Joint::shoulder_right).x);
    const glm::dvec3 raised = person[Joint::hand_left];
    EXPECT_LT(glm::length(at(Joint::hand_right) - glm::dvec3(0.2 - raised.x, raised.y, raised.z)),
              0.05);
}

TEST_F(Troupe, AFullListOfMaterialsLeavesThePlainOne) {
    AvatarTroupe troupe(rig(), {});
    const BodyFrame frame = crowd(1, 0);
    troupe.step(moment_of(frame, kFrameS));
    Scene scene;
    scene.materials.resize(kMaxMaterials - 1);
    troupe.fill(scene, 10);
    EXPECT_EQ(scene.materials.size(), kMaxMaterials - 1);
    for (const MeshNode& node : scene.meshes) EXPECT_EQ(node.material, 0u);
}

}  // namespace
}  // namespace kino::test
