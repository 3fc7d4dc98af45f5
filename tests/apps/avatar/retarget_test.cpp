#include "apps/avatar/retarget.h"

#include <array>
#include <numbers>
#include <random>

#include "apps/avatar/avatar_aim.h"
#include "apps/avatar/turns.h"
#include "posed.h"

namespace kino::test {
namespace {

constexpr double kDt = 1.0 / 30;

std::shared_ptr<const RestBody> mannequin_rest() {
    static const auto rest =
        std::make_shared<const RestBody>(make_rest_body(*rig_called("mannequin")));
    return rest;
}

BodyAim standing() {
    return aim_of(pose_body(standing_pose()), {}, {0, 0, 1});
}

double turned_rad(const glm::dquat& a, const glm::dquat& b) {
    return angle_of(b * glm::conjugate(a));
}

bool is_limb_end(Joint joint) {
    return joint != Joint::hip_left && joint != Joint::hip_right && joint != Joint::shoulder_left &&
           joint != Joint::shoulder_right;
}

// The law of Proof 10: the avatar's bones point where the person's do.
TEST(Retargeting, BonesPointWithinOneDegreeOfTheJoints) {
    for (const char* name : {"mannequin", "robot"}) {
        const auto rig = rig_called(name);
        for (const Motion motion : all_motions()) {
            AvatarTroupe troupe(rig, {.idle = false});
            for (int i = 0; i < 60; ++i) {
                const PosedBody person = person_at(motion, 1 + i * kDt, {0.3, 0, -2});
                BodyFrame frame;
                frame.bodies = {body_of(person)};
                troupe.step(moment_of(frame, kDt));
                const Scene scene = filled(troupe);
                ASSERT_FALSE(scene.meshes.empty());
                for (std::size_t j = 1; j < kJointCount; ++j) {
                    const auto joint = static_cast<Joint>(j);
                    // A rig's own pelvis and shoulder girdle are of one piece, within limits.
                    if (!is_limb_end(joint)) continue;
                    EXPECT_LT(bone_error_deg(*rig, scene.meshes[0], person, joint), 1.0)
                        << name << " " << motion_name(motion) << " " << joint_name(joint) << " "
                        << i;
                }
            }
        }
    }
}

// A rig of the person's proportions has its joints where the person's are.
TEST(Retargeting, TheMannequinsJointsAreThePersons) {
    const auto rig = rig_called("mannequin");
    for (const Motion motion : {Motion::idle, Motion::dance, Motion::squat}) {
        AvatarTroupe troupe(rig, {.idle = false});
        PosedBody person{};
        for (int i = 0; i < 30; ++i) {
            person = person_at(motion, 2 + i * kDt);
            BodyFrame frame;
            frame.bodies = {body_of(person)};
            troupe.step(moment_of(frame, kDt));
        }
        const Scene scene = filled(troupe);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const auto joint = static_cast<Joint>(j);
            if (joint == Joint::head || joint == Joint::foot_left || joint == Joint::foot_right)
                continue;
            const auto at = posed_joint(*rig, scene.meshes[0], joint);
            ASSERT_TRUE(at);
            EXPECT_LT(glm::length(*at - person[joint]), 0.03) << joint_name(joint);
        }
    }
}

TEST(Retargeting, FeetStandOnTheFloorWithin20Millimetres) {
    for (const char* name : {"mannequin", "robot"}) {
        const auto rig = rig_called(name);
        for (const bool scale : {true, false}) {
            for (const Motion motion : {Motion::idle, Motion::wave, Motion::squat, Motion::tpose}) {
                AvatarTroupe troupe(rig, {.scale_bones = scale, .idle = false});
                for (int i = 0; i < 90; ++i) {
                    const PosedBody person = person_at(motion, 1 + i * kDt, {0.2, 0.5, -2});
                    BodyFrame frame;
                    frame.bodies = {body_of(person)};
                    AvatarMoment moment = moment_of(frame, kDt);
                    moment.floor_y_m = 0.5;
                    troupe.step(moment);
                    // Grown by now.
                    if (i % 15 != 14) continue;
                    std::array<double, 2> low = {9, 9};
                    for (MeshNode node : filled(troupe).meshes) {
                        node.skin = SkinBlend::linear;
                        for (const SkinnedVertex& v : skin_mesh(node)) {
                            const glm::dvec3 p(node.world_from_object * glm::dvec4(v.position, 1));
                            double& side = low[p.x > person[Joint::hip_center].x ? 0 : 1];
                            side = std::min(side, p.y - 0.5);
                        }
                    }
                    for (const double y : low) {
                        EXPECT_NEAR(y, 0, 0.02) << name << " " << motion_name(motion) << " " << i
                                                << (scale ? "" : " own scale");
                    }
                }
            }
        }
    }
}

TEST(Retargeting, SolesAreNeverBelowTheFloor) {
    Retarget retarget(mannequin_rest());
    for (int i = 0; i < 300; ++i) {
        retarget.step(aim_of(person_at(Motion::walk, i * kDt), {0, -0.07, 0}, {0, 0, 1}),
                      {.floor_y_m = 0.0}, kDt);
        for (const int side : {0, 1}) EXPECT_GT(retarget.sole_y_m(side), -0.02) << i;
    }
}

TEST(Retargeting, AntiparallelBonesTurnAboutAFixedAxis) {
    const glm::dvec3 a(0.36, 0.48, 0.8);
    const glm::dquat half = shortest_arc(a, -a, {1, 0, 0});
    EXPECT_LT(glm::length(half * a + a), 1e-12);
    EXPECT_EQ(half, shortest_arc(a, -a, {1, 0, 0}));
    // Also where the wished axis is the bone itself or nothing.
    for (const glm::dvec3& axis : {a, glm::dvec3(0)}) {
        EXPECT_LT(glm::length(shortest_arc(a, -a, axis) * a + a), 1e-12);
    }
    // Every way round: the bone is taken there, by no more than the angle between.
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 500; ++i) {
        const auto any = [&] {
            const double x = normal(random);
            const double y = normal(random);
            return glm::normalize(glm::dvec3(x, y, normal(random)));
        };
        const glm::dvec3 from = any();
        glm::dvec3 to = any();
        if (i % 3 == 0) to = glm::normalize(-from + any() * std::pow(10.0, -(i % 17)));
        const glm::dquat q = shortest_arc(from, to, {0, 1, 0});
        EXPECT_LT(glm::length(q * from - to), 1e-6);
        EXPECT_NEAR(angle_of(q), degrees_between(from, to) / 180 * std::numbers::pi, 1e-6);
    }
}

// A bone that shakes about the opposite of its rest direction neither spins nor flutters.
TEST(Retargeting, ABoneNearTheOppositeOfItsRestDoesNotFlip) {
    const auto rest = mannequin_rest();
    Retarget retarget(rest, {.turn_rate = 1e9});
    BodyAim aim = standing();
    glm::dquat before{1, 0, 0, 0};
    std::mt19937_64 random(2);
    std::normal_distribution<double> noise(0, 0.02);
    for (int i = 0; i < 200; ++i) {
        const double x = noise(random);
        const double y = noise(random);
        const glm::dvec3 way = glm::normalize(-rest->axis[index_of(Joint::elbow_left)] +
                                              glm::dvec3(x, y, noise(random)));
        const glm::dvec3 shoulder = aim.joint_m[index_of(Joint::shoulder_left)];
        aim.joint_m[index_of(Joint::elbow_left)] = shoulder + way * 0.28;
        aim.joint_m[index_of(Joint::wrist_left)] = shoulder + way * 0.53;
        aim.joint_m[index_of(Joint::hand_left)] = shoulder + way * 0.62;
        retarget.step(aim, {}, kDt);
        const glm::dquat now = retarget.turn(Joint::elbow_left);
        if (i > 0) {
            EXPECT_LT(turned_rad(before, now), 0.35) << i;
        }
        before = now;
    }
}

TEST(Retargeting, ZeroLengthBonesAndEqualJointsKeepTheLastTurn) {
    Retarget retarget(mannequin_rest());
    BodyAim aim = standing();
    retarget.step(aim, {}, kDt);
    const glm::dquat before = retarget.turn(Joint::wrist_left);
    aim.joint_m[index_of(Joint::wrist_left)] = aim.joint_m[index_of(Joint::elbow_left)];
    for (int i = 0; i < 10; ++i) retarget.step(aim, {}, kDt);
    EXPECT_LT(turned_rad(before, retarget.turn(Joint::wrist_left)), 1e-9);
    // All in one place: nothing but the place is known.
    BodyAim point;
    point.joint_m.fill({1, 2, 3});
    point.seen.fill(true);
    Retarget other(mannequin_rest());
    for (int i = 0; i < 5; ++i) other.step(point, {.floor_y_m = 0.0}, kDt);
    ASSERT_TRUE(other.placed());
    for (const glm::dvec3& p : other.joint_m()) EXPECT_LT(glm::length(p - glm::dvec3(1, 2, 3)), 3);
}

// Held while lost, then at ease; coming back it moves, and never jumps.
TEST(Retargeting, LostJointsHoldThenEaseAndReturnWithoutAJump) {
    const RetargetLimits limits;
    Retarget retarget(mannequin_rest(), limits);
    BodyAim up = standing();
    const glm::dvec3 shoulder = up.joint_m[index_of(Joint::shoulder_left)];
    const auto raise = [&](BodyAim& aim) {
        aim.joint_m[index_of(Joint::elbow_left)] = shoulder + glm::dvec3(0.05, 0.28, 0);
        aim.joint_m[index_of(Joint::wrist_left)] = shoulder + glm::dvec3(0.05, 0.53, 0.02);
        aim.joint_m[index_of(Joint::hand_left)] = shoulder + glm::dvec3(0.05, 0.61, 0.02);
    };
    raise(up);
    retarget.step(up, {}, kDt);
    const glm::dquat held = retarget.turn(Joint::elbow_left);
    BodyAim lost = up;
    for (const Joint j : {Joint::elbow_left, Joint::wrist_left, Joint::hand_left})
        lost.seen[index_of(j)] = false;
    glm::dquat before = held;
    double most = 0;
    const auto step = [&](const BodyAim& aim) {
        retarget.step(aim, {}, kDt);
        most = std::max(most, turned_rad(before, retarget.turn(Joint::elbow_left)));
        before = retarget.turn(Joint::elbow_left);
    };
    for (int i = 0; i < 14; ++i) step(lost);
    EXPECT_LT(turned_rad(held, before), 1e-9);
    for (int i = 0; i < 120; ++i) step(lost);
    // At ease the arm hangs.
    EXPECT_LT((before * mannequin_rest()->axis[index_of(Joint::elbow_left)]).y, -0.9);
    EXPECT_LT(most, limits.ease_rate * kDt + 1e-9);
    // Back: at most the returning rate in the first step, there within a second.
    most = 0;
    step(up);
    EXPECT_GT(most, 0.01);
    EXPECT_LT(most, limits.returning_turn_rate * kDt + 1e-9);
    for (int i = 0; i < 30; ++i) step(up);
    EXPECT_LT(most, limits.turn_rate * kDt + 1e-9);
    EXPECT_LT(turned_rad(held, before), 1e-6);
}

TEST(Retargeting, NothingTurnsOrMovesFasterThanItsBound) {
    const RetargetLimits limits;
    Retarget retarget(mannequin_rest(), limits);
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    retarget.step(standing(), {}, kDt);
    for (int i = 0; i < 200; ++i) {
        BodyAim noise = standing();
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const double x = any(random);
            const double y = any(random);
            noise.joint_m[j] += 0.5 * glm::dvec3(x, y, any(random));
            noise.seen[j] = any(random) > -0.5;
        }
        const glm::dvec3 root = retarget.joint_m()[0];
        const glm::dquat pelvis = retarget.turn(Joint::hip_center);
        retarget.step(noise, {}, kDt);
        EXPECT_LE(glm::length(retarget.joint_m()[0] - root), limits.move_rate_m * kDt + 1e-9);
        EXPECT_LE(turned_rad(pelvis, retarget.turn(Joint::hip_center)),
                  limits.turn_rate * kDt + 1e-9);
    }
}

TEST(Retargeting, TwistFollowsTheElbowsPlaneAndIsSharedOut) {
    const auto rest = mannequin_rest();
    Retarget retarget(rest);
    for (const double bend_deg : {-60.0, 0.0, 60.0}) {
        BodyAim aim = standing();
        const glm::dvec3 shoulder = aim.joint_m[index_of(Joint::shoulder_left)];
        const double bend = bend_deg * std::numbers::pi / 180;
        aim.joint_m[index_of(Joint::elbow_left)] = shoulder + glm::dvec3(0.285, 0, 0);
        // The forearm stands across the level upper arm, forwards, turned up or down.
        aim.joint_m[index_of(Joint::wrist_left)] =
            shoulder + glm::dvec3(0.285, 0.25 * std::sin(bend), 0.25 * std::cos(bend));
        aim.seen[index_of(Joint::hand_left)] = false;
        Retarget fresh(rest);
        fresh.step(aim, {}, kDt);
        const glm::dvec3 hinge =
            fresh.turn(Joint::elbow_left) * rest->hinge[index_of(Joint::elbow_left)];
        const glm::dvec3 across_both(0, -std::cos(bend), std::sin(bend));
        EXPECT_GT(std::abs(glm::dot(hinge, across_both)), 0.999) << bend_deg;
    }
    // The first joint of the upper arm takes a quarter of the twist, the second three.
    const auto rig = rig_called("mannequin");
    double shares = 0;
    for (std::size_t r = 0; r < rig->joints.size(); ++r) {
        if (rig->joints[r].name == "upper_arm.L") {
            EXPECT_NEAR(rest->drives[r].share, 0.25, 1e-9);
        }
        if (rig->joints[r].name == "upper_arm_twist.L") {
            EXPECT_NEAR(rest->drives[r].share, 0.75, 1e-9);
        }
        if (rest->drives[r].segment == Joint::elbow_left) shares += rest->drives[r].share;
    }
    EXPECT_NEAR(shares, 1, 1e-9);
}

TEST(Retargeting, LimitsStopBonesAtTheirCones) {
    const auto rest = mannequin_rest();
    Retarget retarget(rest);
    BodyAim aim = standing();
    // A head between the knees.
    aim.joint_m[index_of(Joint::head)] =
        aim.joint_m[index_of(Joint::shoulder_center)] - glm::dvec3(0, 0.19, 0.02);
    retarget.step(aim, {}, kDt);
    const glm::dvec3 head = retarget.turn(Joint::head) * rest->axis[index_of(Joint::head)];
    const glm::dvec3 chest =
        retarget.turn(Joint::shoulder_center) * rest->axis[index_of(Joint::head)];
    EXPECT_NEAR(degrees_between(head, chest), 75, 0.1);
}

TEST(Retargeting, BonesTakeThePersonsLengthsSmoothlyAndWithinBounds) {
    const RetargetLimits limits;
    const auto rest = mannequin_rest();
    // A child.
    BodyAim small = standing();
    for (glm::dvec3& p : small.joint_m) p *= 0.6;
    Retarget retarget(rest, limits);
    retarget.step(small, {}, kDt);
    EXPECT_NEAR(retarget.scale(), 0.6, 0.02);
    EXPECT_NEAR(retarget.ratio(Joint::elbow_left), 1, 0.03);
    // Grown at once, the avatar grows over a while.
    double before = retarget.scale();
    for (int i = 0; i < 90; ++i) {
        retarget.step(standing(), {}, kDt);
        EXPECT_LT(std::abs(retarget.scale() - before), 0.4 * kDt / limits.scale_time_s + 1e-9);
        before = retarget.scale();
    }
    EXPECT_NEAR(before, 1, 0.02);
    // An arm of two metres is the tracker's mistake.
    BodyAim odd = standing();
    odd.joint_m[index_of(Joint::wrist_left)] += glm::dvec3(0, -0.6, 0);
    for (int i = 0; i < 90; ++i) retarget.step(odd, {}, kDt);
    EXPECT_LE(retarget.ratio(Joint::wrist_left), limits.ratio_high);
    // Its own scale.
    retarget.step(small, {.scale_bones = false}, kDt);
    EXPECT_EQ(retarget.scale(), 1);
    EXPECT_EQ(retarget.ratio(Joint::wrist_left), 1);
}

TEST(Retargeting, TenJointsOfASeatedPersonAreEnough) {
    BodyAim seated = standing();
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const bool upper = j >= index_of(Joint::shoulder_center) && j < index_of(Joint::hip_left);
        seated.seen[j] = upper;
    }
    Retarget retarget(mannequin_rest());
    retarget.step(seated, {}, kDt);
    ASSERT_TRUE(retarget.placed());
    for (const Joint j : {Joint::shoulder_center, Joint::elbow_left, Joint::hand_right}) {
        EXPECT_LT(glm::length(retarget.joint_m()[index_of(j)] - seated.joint_m[index_of(j)]), 0.05)
            << joint_name(j);
    }
    // Nothing but a hand is nobody.
    BodyAim hand;
    hand.seen[index_of(Joint::hand_left)] = true;
    Retarget other(mannequin_rest());
    other.step(hand, {}, kDt);
    EXPECT_FALSE(other.placed());
}

// Half a turn of twist can be had either way; noise there must not choose anew in every frame.
TEST(Retargeting, TwistNearHalfATurnDoesNotFlutter) {
    Retarget retarget(mannequin_rest(), {.turn_rate = 1e9});
    BodyAim aim = standing();
    const glm::dvec3 shoulder = aim.joint_m[index_of(Joint::shoulder_left)];
    aim.joint_m[index_of(Joint::elbow_left)] = shoulder + glm::dvec3(0.285, 0, 0);
    aim.seen[index_of(Joint::hand_left)] = false;
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> noise(-0.1, 0.1);
    glm::dquat before{1, 0, 0, 0};
    for (int i = 0; i < 160; ++i) {
        // From forwards over the top to backwards, where it shakes.
        const double angle = i < 60 ? std::numbers::pi * i / 60 : std::numbers::pi + noise(random);
        aim.joint_m[index_of(Joint::wrist_left)] =
            shoulder + glm::dvec3(0.285, 0.25 * std::sin(angle), 0.25 * std::cos(angle));
        retarget.step(aim, {}, kDt);
        const glm::dquat now = retarget.turn(Joint::elbow_left);
        if (i > 0) {
            EXPECT_LT(turned_rad(before, now), 0.3) << i;
        }
        before = now;
    }
}

TEST(Retargeting, TheMatricesShareTheTwistAndMeetAtTheJoints) {
    const auto rig = rig_called("mannequin");
    const auto rest = mannequin_rest();
    BodyAim aim = standing();
    // Long forearms and short shins, and a twisted arm.
    for (const Joint j : {Joint::wrist_left, Joint::hand_left}) {
        aim.joint_m[index_of(j)] = aim.joint_m[index_of(Joint::elbow_left)] +
                                   glm::dvec3(j == Joint::wrist_left ? 0.31 : 0.40, 0.05, 0.05);
    }
    for (const Joint j : {Joint::ankle_right, Joint::foot_right}) {
        aim.joint_m[index_of(j)].y += 0.06;
    }
    Retarget retarget(rest);
    retarget.step(aim, {}, kDt);
    const glm::dvec3 origin = retarget.joint_m()[0];
    const auto pose = retarget.object_from_bind(origin);
    EXPECT_GT(retarget.ratio(Joint::wrist_left), 1.1);
    EXPECT_LT(retarget.ratio(Joint::ankle_right), 0.92);
    const auto posed = [&](Joint bone, const glm::dvec3& point) {
        const int r = rig->of_joint[index_of(bone)];
        return origin + retarget.scale() *
                            glm::dvec3(pose[static_cast<std::size_t>(r)] * glm::vec4(point, 1));
    };
    for (const Joint end : {Joint::elbow_left, Joint::wrist_left, Joint::knee_right,
                            Joint::ankle_right, Joint::elbow_right}) {
        const Joint start = kJointParent[index_of(end)];
        for (const Joint at : {start, end}) {
            EXPECT_LT(glm::length(posed(start, rest->joint_m[index_of(at)]) -
                                  retarget.joint_m()[index_of(at)]),
                      1e-4)
                << joint_name(end) << " " << joint_name(at);
        }
    }
    // Two joints of the upper arm: what is missing of the twist is three quarters and one.
    const glm::dquat whole = retarget.turn(Joint::elbow_left);
    const glm::dvec3 hinge = rest->hinge[index_of(Joint::elbow_left)];
    const auto missing = [&](const char* name) {
        glm::dvec3 turned(0);
        for (std::size_t r = 0; r < rig->joints.size(); ++r) {
            if (rig->joints[r].name == name) turned = glm::dmat3(glm::mat3(pose[r])) * hinge;
        }
        return angle_about(whole * rest->axis[index_of(Joint::elbow_left)], turned, whole * hinge);
    };
    const double first = missing("upper_arm.L");
    const double second = missing("upper_arm_twist.L");
    EXPECT_GT(std::abs(first), 0.2);
    EXPECT_NEAR(second, first / 3, 1e-5);
}

// A rig of its own size stands with its knees as the person's are, not squatting or floating.
TEST(Retargeting, ARigOfItsOwnSizeStandsAsThePersonDoes) {
    BodyAim child = standing();
    for (glm::dvec3& p : child.joint_m) p *= 0.7;
    Retarget retarget(mannequin_rest());
    for (int i = 0; i < 10; ++i) {
        retarget.step(child, {.scale_bones = false, .floor_y_m = 0.0}, kDt);
    }
    const auto bend = [](const PerJoint<glm::dvec3>& p) {
        return degrees_between(p[index_of(Joint::knee_left)] - p[index_of(Joint::hip_left)],
                               p[index_of(Joint::ankle_left)] - p[index_of(Joint::knee_left)]);
    };
    EXPECT_NEAR(bend(retarget.joint_m()), bend(child.joint_m), 5);
    EXPECT_NEAR(retarget.sole_y_m(0), 0, 0.005);
}

}  // namespace
}  // namespace kino::test
