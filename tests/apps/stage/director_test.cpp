#include "apps/stage/director.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <set>

#include "apps/stage/bundled.h"
#include "apps/stage/trail.h"
#include "tests/apps/stage/scene_bits.h"
#include "tests/support/random.h"

namespace kino {
namespace {

constexpr double kStep = 1.0 / 30;

StageSet stage_of(const std::string& members) {
    auto file = scene_file_from_json("{\"kinoscope_scene\": 1, " + members + "}", "test");
    EXPECT_TRUE(file.has_value()) << file.error().to_string();
    auto stage = make_stage(std::move(*file), {});
    EXPECT_TRUE(stage.has_value()) << stage.error().to_string();
    return *std::move(stage);
}

/// Somebody about 2.5 m ahead, in depth-camera space; arms move with time.
Body somebody(std::uint32_t id, double time_s, double x_m = 0) {
    Body body{.id = id};
    for (std::size_t i = 0; i < kJointCount; ++i) {
        const double k = static_cast<double>(i);
        body.joints[i] = {.position_m = {x_m + 0.1 * std::sin(k), 0.9 - 0.08 * k, 2.5},
                          .state = JointState::tracked,
                          .confidence = 1};
    }
    body[Joint::head].position_m = {x_m, -0.6, 2.5};
    body[Joint::foot_left].position_m = {x_m + 0.1, 1.05, 2.5};
    body[Joint::foot_right].position_m = {x_m - 0.1, 1.06, 2.5};
    const double turn = 2 * time_s;
    body[Joint::hand_right].position_m = {x_m - 0.4 + 0.3 * std::cos(turn),
                                          -0.1 + 0.3 * std::sin(turn), 2.2};
    body[Joint::hand_left].position_m = {x_m + 0.4 + 0.3 * std::cos(turn),
                                         -0.1 - 0.3 * std::sin(turn), 2.2};
    return body;
}

Scene step(Director& director, const BodyFrame* bodies, double dt_s = kStep) {
    director.step({.dt_s = dt_s,
                   .bodies = bodies,
                   .world_from_depth = test::sensor_pose(),
                   .middle_m = test::sensor_pose() * glm::dvec3(0, 0, 2.5)});
    Scene scene;
    director.fill(scene);
    return scene;
}

/// What every scene of every stage must keep.
void expect_sound(const Scene& scene) {
    std::set<std::uint32_t> ids;
    EXPECT_LE(scene.meshes.size(), static_cast<std::size_t>(kMaxStageNodes));
    EXPECT_LE(scene.materials.size(), kMaxMaterials - 1);
    for (const MeshNode& node : scene.meshes) {
        EXPECT_TRUE(ids.insert(node.id).second) << node.id;
        EXPECT_GE(node.id, 1u);
        EXPECT_LE(node.id, 65535u);
        EXPECT_NE(node.mesh, nullptr);
        EXPECT_LE(node.material, scene.materials.size());
        EXPECT_TRUE(test::all_finite(node.world_from_object));
        EXPECT_TRUE(test::all_finite(node.previous_world_from_object));
    }
    std::size_t local = 0;
    for (const Light& light : scene.lights) {
        local += light.kind != LightKind::directional;
        for (int k = 0; k < 3; ++k) {
            EXPECT_TRUE(std::isfinite(light.position[k]) && std::isfinite(light.direction[k]));
            EXPECT_TRUE(std::isfinite(light.color[k]) && light.color[k] >= 0);
        }
        EXPECT_GT(light.radius_m, 0);
        if (light.kind != LightKind::point) {
            EXPECT_NEAR(glm::length(light.direction), 1, 0.2);
        }
    }
    EXPECT_LE(local, static_cast<std::size_t>(kMaxStageLights));
}

TEST(Director, LightsAreWhereTheJointsAreInEveryFrame) {
    Director director(stage_of(R"("roles": [{"light": {"intensity": 2}, "fade_s": 0}])"));
    for (int i = 0; i < 40; ++i) {
        const BodyFrame frame{.bodies = {somebody(4, i * kStep)}};
        const Scene scene = step(director, &frame);
        ASSERT_EQ(scene.lights.size(), kJointCount);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const glm::dvec3 joint =
                test::sensor_pose() * glm::dvec3(frame.bodies[0].joints[j].position_m);
            EXPECT_LT(glm::distance(scene.lights[j].position, joint), 1e-3) << i << " " << j;
        }
    }
}

TEST(Director, OffsetsAndDirectionsAreInStageAxesAndLimbsAimAlongThem) {
    Director director(stage_of(
        R"("roles": [{"joints": ["hand_right"], "fade_s": 0,
                      "light": {"kind": "spot", "at_m": [0, 0, 0.5], "direction": [0, 0, 1]}},
                     {"joints": ["hand_right"], "fade_s": 0, "aim": "limb",
                      "light": {"kind": "spot"}},
                     {"joints": ["hand_right"], "fade_s": 0, "aim": "mirror",
                      "light": {"kind": "spot"}}])"));
    const BodyFrame frame{.bodies = {somebody(1, 0)}};
    const Scene scene = step(director, &frame);
    ASSERT_EQ(scene.lights.size(), 3u);
    const glm::dvec3 hand = scene.lights[1].position;
    const glm::dvec3 off = scene.lights[0].position - hand;
    EXPECT_NEAR(glm::length(off), 0.5, 1e-9);
    EXPECT_NEAR(off.y, 0, 1e-9);
    // z of the stage points to the sensor.
    const glm::dvec3 to_sensor = test::sensor_pose().translation - hand;
    EXPECT_GT(glm::dot(off, to_sensor), 0.4 * glm::length(to_sensor));
    EXPECT_NEAR(glm::dot(scene.lights[0].direction, off), 0.5, 1e-9);
    const glm::dvec3 wrist =
        test::sensor_pose() * glm::dvec3(frame.bodies[0][Joint::wrist_right].position_m);
    EXPECT_NEAR(glm::dot(scene.lights[1].direction, glm::normalize(hand - wrist)), 1, 1e-6);
    // The same but for the part towards the viewer, which goes into the picture.
    const glm::dvec3 out = 2.0 * off;
    const glm::dvec3 limb = scene.lights[1].direction, beam = scene.lights[2].direction;
    EXPECT_NEAR(glm::dot(beam, out), -std::abs(glm::dot(limb, out)), 1e-9);
    EXPECT_NEAR(glm::length(beam), 1, 1e-9);
}

TEST(Director, TheFloorIsUnderTheFeetAndTheStageFacesTheSensor) {
    Director director(stage_of(R"("lights": [])"));
    const BodyFrame frame{.bodies = {somebody(1, 0)}};
    step(director, &frame);
    ASSERT_TRUE(director.world_from_stage());
    const Pose& stage = *director.world_from_stage();
    const glm::dvec3 foot =
        test::sensor_pose() * glm::dvec3(frame.bodies[0][Joint::foot_right].position_m);
    EXPECT_NEAR(stage.translation.y, foot.y, 0.08);
    EXPECT_LT(stage.translation.y, foot.y);
    EXPECT_NEAR((stage.rotation * glm::dvec3(0, 1, 0)).y, 1, 1e-12);
    const glm::dvec3 local = inverse(stage) * test::sensor_pose().translation;
    EXPECT_NEAR(local.x, 0, 1e-9);
    EXPECT_GT(local.z, 2);
    EXPECT_TRUE(is_valid(stage));
}

TEST(Director, TheStageMovesToTheFirstPersonAndStaysThere) {
    Director director(stage_of(R"("lights": [])"));
    step(director, nullptr);
    const Pose before = *director.world_from_stage();
    const BodyFrame near{.bodies = {somebody(1, 0, 0.7)}};
    step(director, &near);
    const Pose found = *director.world_from_stage();
    EXPECT_GT(glm::distance(before.translation, found.translation), 0.3);
    const BodyFrame moved{.bodies = {somebody(1, 1, -0.5)}};
    step(director, &moved);
    EXPECT_TRUE(*director.world_from_stage() == found);
    director.reset();
    EXPECT_FALSE(director.world_from_stage());
}

TEST(Director, TrailsKeepTheirSpacingLengthAndLife) {
    Director director(stage_of(
        R"("roles": [{"joints": ["hand_right"],
                      "trail": {"lights": 40, "spacing_m": 0.03, "life_s": 2}}])"));
    std::size_t most = 0;
    for (int i = 0; i < 120; ++i) {
        const BodyFrame frame{.bodies = {somebody(1, i * kStep)}};
        const Scene scene = step(director, &frame);
        expect_sound(scene);
        most = std::max(most, scene.lights.size());
        for (std::size_t k = 1; k < scene.lights.size(); ++k) {
            EXPECT_NEAR(glm::distance(scene.lights[k].position, scene.lights[k - 1].position), 0.03,
                        1e-4);
        }
        // The newest is within a spacing of the hand.
        const glm::dvec3 hand =
            test::sensor_pose() * glm::dvec3(frame.bodies[0][Joint::hand_right].position_m);
        ASSERT_FALSE(scene.lights.empty());
        EXPECT_LT(glm::distance(scene.lights[0].position, hand), 0.0301);
    }
    // 0.6 m/s over 2 s would be 40; those that have faded do not burn.
    EXPECT_LE(most, 40u);
    EXPECT_GE(most, 34u);
    // A hand at rest lets its trail die.
    const BodyFrame still{.bodies = {somebody(1, 119 * kStep)}};
    Scene scene;
    for (int i = 0; i < 65; ++i) scene = step(director, &still);
    EXPECT_EQ(scene.lights.size(), 0u);
    EXPECT_EQ(scene.meshes.size(), 0u);
}

TEST(Trails, AJumpBeginsANewStrokeAndAFullRingKeepsTheNewest) {
    Trail trail(8, 0.1);
    trail.reach({0, 0, 0}, 0);
    trail.reach({0.35, 0, 0}, 1);
    ASSERT_EQ(trail.size(), 4u);
    EXPECT_NEAR(trail.newest(0).world_m.x, 0.3, 1e-12);
    EXPECT_FALSE(trail.newest(3).joined);
    EXPECT_TRUE(trail.newest(0).joined);
    trail.reach({5, 0, 0}, 2);
    ASSERT_EQ(trail.size(), 5u);
    EXPECT_FALSE(trail.newest(0).joined);
    for (int i = 1; i <= 10; ++i) trail.reach({5 + 0.1 * i + 1e-9, 0, 0}, 2 + i);
    ASSERT_EQ(trail.size(), 8u);
    EXPECT_NEAR(trail.newest(0).world_m.x, 6, 1e-6);
    EXPECT_NEAR(trail.newest(7).world_m.x, 5.3, 1e-6);
    trail.forget_before(9.5);
    ASSERT_EQ(trail.size(), 3u);
    EXPECT_NEAR(trail.newest(2).world_m.x, 5.8, 1e-6);
    trail.lift();
    trail.reach({6.05, 0, 0}, 20);
    EXPECT_FALSE(trail.newest(0).joined);
}

TEST(Director, LostJointsFadeWhereTheyWereAndNothingIsEverNaN) {
    Director director(
        stage_of(R"("roles": [{"joints": ["hand_left"], "light": {}, "fade_s": 0.5}])"));
    BodyFrame frame{.bodies = {somebody(1, 0)}};
    for (int i = 0; i < 30; ++i) step(director, &frame);
    const Light lit = step(director, &frame).lights.at(0);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    frame.bodies[0][Joint::hand_left].position_m = {nan, 0, 2};
    float last = lit.color.r;
    for (int i = 0; i < 14; ++i) {
        const Scene scene = step(director, &frame);
        ASSERT_EQ(scene.lights.size(), 1u) << i;
        EXPECT_LT(scene.lights[0].color.r, last);
        EXPECT_TRUE(scene.lights[0].position == lit.position);
        last = scene.lights[0].color.r;
    }
    for (int i = 0; i < 3; ++i) step(director, &frame);
    EXPECT_EQ(step(director, &frame).lights.size(), 0u);
    // It comes back as it went.
    frame.bodies[0] = somebody(1, 0);
    const Scene back = step(director, &frame);
    ASSERT_LE(back.lights.size(), 1u);
    if (!back.lights.empty()) {
        EXPECT_LT(back.lights[0].color.r, 0.2f * lit.color.r);
    }
}

TEST(Director, ASwarmFillsUpAndTakesItsTime) {
    Director director(stage_of(
        R"("swarms": [{"count": 300, "fill_to": 200, "bead_m": 0.01}],
           "roles": [{"joints": [], "light": {}, "fade_s": 0}])"));
    Scene scene = step(director, nullptr);
    EXPECT_EQ(scene.lights.size(), 200u);
    EXPECT_EQ(scene.meshes.size(), 200u);
    const BodyFrame frame{.bodies = {somebody(1, 0), somebody(2, 0, 0.8)}};
    scene = step(director, &frame);
    EXPECT_EQ(scene.lights.size(), 240u);  // those that are too many still fade
    for (int i = 0; i < 40; ++i) scene = step(director, &frame);
    EXPECT_EQ(scene.lights.size(), 200u);
    EXPECT_EQ(director.local_lights(), 200u);
    for (int i = 0; i < 40; ++i) scene = step(director, nullptr);
    EXPECT_EQ(scene.lights.size(), 200u);
}

TEST(Director, SwarmsStayInTheirBoxAndMove) {
    for (const char* movement : {"still", "drift", "orbit", "rise"}) {
        SceneSwarm file{.count = 200, .center_m = {1, 2, 3}, .size_m = {4, 2, 0.5}};
        file.movement = std::string(movement) == "still"   ? SceneMovement::still
                        : std::string(movement) == "drift" ? SceneMovement::drift
                        : std::string(movement) == "orbit" ? SceneMovement::orbit
                                                           : SceneMovement::rise;
        const Swarm swarm(file);
        double moved = 0;
        for (std::size_t i = 0; i < swarm.all().size(); ++i) {
            for (const double time : {0.0, 0.7, 3.0, 1e5}) {
                const SwarmMoment moment = swarm.at(i, time);
                const glm::dvec3 off = glm::abs(moment.stage_m - file.center_m);
                for (int k = 0; k < 3; ++k) EXPECT_LE(off[k], 0.5 * file.size_m[k] + 1e-9);
                EXPECT_GE(moment.weight, 0);
                EXPECT_LE(moment.weight, 1);
            }
            moved += glm::distance(swarm.at(i, 0).stage_m, swarm.at(i, 0.1).stage_m);
        }
        moved /= 200;
        if (file.movement == SceneMovement::still) {
            EXPECT_EQ(moved, 0);
        } else {
            EXPECT_GT(moved, 0.004) << movement;
            EXPECT_LT(moved, 0.2) << movement;
        }
    }
}

TEST(Director, IdleLightsBurnOnlyWhileNobodyIsThere) {
    Director director(stage_of(R"("swarms": [{"count": 10, "when": "idle"},
                                             {"count": 4, "when": "people"}])"));
    EXPECT_EQ(step(director, nullptr).lights.size(), 10u);
    const BodyFrame frame{.bodies = {somebody(1, 0)}};
    Scene scene;
    for (int i = 0; i < 35; ++i) scene = step(director, &frame);
    EXPECT_EQ(scene.lights.size(), 4u);
    const BodyFrame nobody;
    for (int i = 0; i < 35; ++i) scene = step(director, &nobody);
    EXPECT_EQ(scene.lights.size(), 10u);
}

TEST(Director, LightPaintingHasAboutAThousandLightsForNobodyOneAndTwo) {
    for (const int people : {0, 1, 2}) {
        auto stage = open_stage("light-painting");
        ASSERT_TRUE(stage.has_value()) << stage.error().to_string();
        Director director(std::move(*stage));
        Scene scene;
        for (int i = 0; i < 400; ++i) {
            BodyFrame frame;
            for (int k = 0; k < people; ++k) {
                frame.bodies.push_back(somebody(static_cast<std::uint32_t>(k + 1), i * kStep, k));
            }
            scene = step(director, &frame);
            if (i % 50 == 49) expect_sound(scene);
        }
        EXPECT_GE(scene.lights.size(), 950u) << people;
        EXPECT_LE(scene.lights.size(), 1150u) << people;
    }
}

TEST(Director, EveryBundledSceneKeepsItsWordWhateverJointsDo) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const BundledScene& bundled : bundled_scenes()) {
        auto stage = open_stage(std::string(bundled.name));
        ASSERT_TRUE(stage.has_value()) << stage.error().to_string();
        Director director(std::move(*stage));
        test::Random random(8);
        for (int i = 0; i < 150; ++i) {
            BodyFrame frame;
            for (int k = random.integer(0, 7); k > 0; --k) {
                // Ids come, go and are there twice.
                Body body = somebody(static_cast<std::uint32_t>(random.integer(0, 9)), i * kStep,
                                     random.real(-3, 3));
                for (JointPosition& joint : body.joints) {
                    if (random.chance(0.1)) joint.state = JointState::lost;
                    if (random.chance(0.05)) joint.position_m.x = nan;
                    if (random.chance(0.05)) joint.position_m.z = infinite;
                    if (random.chance(0.02)) joint.position_m *= 1e30f;
                }
                frame.bodies.push_back(body);
            }
            const double dt = random.chance(0.1)   ? nan
                              : random.chance(0.1) ? -1
                                                   : random.real(0, 9);
            expect_sound(step(director, random.chance(0.2) ? nullptr : &frame, dt));
            if (HasFailure()) FAIL() << bundled.name << " step " << i;
        }
    }
}

TEST(Director, TheSameMomentsGiveTheSameBits) {
    for (const BundledScene& bundled : bundled_scenes()) {
        std::vector<std::string> runs;
        for (int run = 0; run < 2; ++run) {
            Director director(*open_stage(std::string(bundled.name)));
            // The second run is one after a reset, too.
            if (run == 1) {
                const BodyFrame other{.bodies = {somebody(9, 3)}};
                for (int i = 0; i < 20; ++i) step(director, &other);
                director.reset();
            }
            std::string bits;
            for (int i = 0; i < 25; ++i) {
                const BodyFrame frame{.bodies = {somebody(1, i * kStep), somebody(2, i, 1)}};
                bits += test::bits_of(step(director, i % 9 == 8 ? nullptr : &frame));
            }
            runs.push_back(bits);
        }
        EXPECT_GT(runs[0].size(), 100u) << bundled.name;
        EXPECT_TRUE(runs[0] == runs[1]) << bundled.name;
    }
}

TEST(Director, PreviousTransformsAreThoseOfTheStepBefore) {
    Director director(stage_of(
        R"("materials": [{"name": "a"}], "meshes": [{"shape": "chair"}],
           "roles": [{"joints": ["hand_right"], "fade_s": 0,
                      "prop": {"copies": 3, "orbit_m": 0.2}}])"));
    Scene before;
    for (int i = 0; i < 10; ++i) {
        const BodyFrame frame{.bodies = {somebody(1, i * kStep)}};
        const Scene scene = step(director, &frame);
        ASSERT_EQ(scene.meshes.size(), 4u);
        if (i > 0) {
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_EQ(scene.meshes[k].id, before.meshes[k].id);
                EXPECT_TRUE(scene.meshes[k].previous_world_from_object ==
                            before.meshes[k].world_from_object);
            }
        }
        before = scene;
    }
}

TEST(Director, MasksNameTheLiveSurfaceAndMaterialsInOrder) {
    const StageSet stage = stage_of(
        R"("materials": [{"name": "a"}, {"name": "b"}],
           "lights": [{"only": ["live"]}, {"only": ["b"]}, {"only": ["a", "live"]}, {}])");
    const Scene scene = [&] {
        Director director(stage);
        return step(director, nullptr);
    }();
    ASSERT_EQ(scene.lights.size(), 4u);
    EXPECT_EQ(scene.lights[0].material_mask, 1u);
    EXPECT_EQ(scene.lights[1].material_mask, 4u);
    EXPECT_EQ(scene.lights[2].material_mask, 3u);
    EXPECT_EQ(scene.lights[3].material_mask, ~0u);
}

TEST(Stages, RepeatsStandInRowsAndShapesHaveTheirSize) {
    const StageSet stage = stage_of(
        R"("materials": [{"name": "a"}],
           "meshes": [{"shape": "column", "size_m": [0.4, 3, 0.4], "at_m": [1, 0, 0],
                       "repeat": [{"count": 3, "step_m": [2, 0, 0]},
                                  {"count": 2, "step_m": [0, 0, -1]}]},
                      {"shape": "chair", "size_m": [0.44, 0.9, 0.46]},
                      {"shape": "room", "size_m": [4, 3, 5]}])");
    ASSERT_EQ(stage.standing.size(), 8u);
    EXPECT_EQ(stage.standing[5].stage_from_object[3], glm::dvec4(5, 0, -1, 1));
    const auto box_of = [](const MeshAsset& mesh) {
        glm::vec3 least(1e9f), most(-1e9f);
        for (const glm::vec3& p : mesh.positions) {
            least = glm::min(least, p);
            most = glm::max(most, p);
        }
        return std::pair(least, most);
    };
    const auto [column_least, column_most] = box_of(*stage.standing[0].mesh);
    EXPECT_NEAR(column_least.y, 0, 1e-6);
    EXPECT_NEAR(column_most.y, 3, 1e-6);
    const auto [chair_least, chair_most] = box_of(*stage.standing[6].mesh);
    EXPECT_NEAR(chair_least.y, 0, 1e-3);
    EXPECT_NEAR(chair_most.y, 0.9, 1e-3);
    EXPECT_NEAR(chair_most.z - chair_least.z, 0.46, 0.02);
    // A room is seen from within: its sides look at its middle.
    const MeshAsset& room = *stage.standing[7].mesh;
    for (std::size_t i = 0; i < room.indices.size(); i += 3) {
        const glm::vec3 a = room.positions[room.indices[i]];
        const glm::vec3 normal = glm::cross(room.positions[room.indices[i + 1]] - a,
                                            room.positions[room.indices[i + 2]] - a);
        EXPECT_GT(glm::dot(normal, glm::vec3(0, 1.5f, 0) - a), 0);
        EXPECT_GT(glm::dot(room.normals[room.indices[i]], glm::vec3(0, 1.5f, 0) - a), 0);
    }
}

TEST(Stages, UnknownNamesTellWhatThereIs) {
    const auto stage = open_stage("disco");
    ASSERT_FALSE(stage.has_value());
    EXPECT_THAT(stage.error().hint, testing::HasSubstr("light-painting"));
}

}  // namespace
}  // namespace kino
