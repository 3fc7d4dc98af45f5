#include "skeleton/synthetic/synthetic_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "calibration/projection.h"
#include "skeleton/synthetic/color_sensor.h"
#include "tests/reference/raycast_reference.h"

namespace kino {
namespace {

using testing::HasSubstr;

std::unique_ptr<SyntheticSource> make(Motion motion, int width = 320, int height = 240,
                                      bool noise = true) {
    DepthSensorOptions options;
    options.noise = noise;
    auto source = SyntheticSource::create(make_scene(motion, width, height), options);
    EXPECT_TRUE(source);
    EXPECT_TRUE(subscribe_all(**source));
    return std::move(*source);
}

FrameSet frame_at(Source& source, std::int64_t index) {
    EXPECT_TRUE(source.timeline()->seek(index));
    auto set = source.next(0);
    EXPECT_TRUE(set && *set);
    return **set;
}

void expect_equal(const FrameSet& a, const FrameSet& b) {
    EXPECT_EQ(a.index, b.index);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.depth->raw, b.depth->raw);
    EXPECT_EQ(a.color->bytes, b.color->bytes);
    ASSERT_EQ(a.bodies->bodies.size(), b.bodies->bodies.size());
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_EQ(a.bodies->bodies[0].joints[j].position_m,
                  b.bodies->bodies[0].joints[j].position_m);
        EXPECT_EQ(a.bodies->bodies[0].joints[j].state, b.bodies->bodies[0].joints[j].state);
    }
}

TEST(SyntheticSource, TheSameFrameTwiceIsTheSameBits) {
    const auto source = make(Motion::dance);
    const FrameSet first = frame_at(*source, 123);
    frame_at(*source, 7);
    expect_equal(first, frame_at(*source, 123));
    expect_equal(first, frame_at(*make(Motion::dance), 123));
}

TEST(SyntheticSource, SeekingGivesWhatPlayingGives) {
    const auto played = make(Motion::walk), sought = make(Motion::walk);
    for (int i = 0; i < 40; ++i) {
        auto set = played->next(0);
        ASSERT_TRUE(set && *set);
        if (i % 13 == 5) expect_equal(**set, frame_at(*sought, i));
    }
}

TEST(SyntheticSource, FramesHeldByAReaderAreNotOverwritten) {
    const auto source = make(Motion::dance);
    const FrameSet held = frame_at(*source, 10);
    const Image<std::uint16_t> depth = held.depth->raw;
    const std::vector<std::uint8_t> color = held.color->bytes;
    for (int i = 11; i < 20; ++i) frame_at(*source, i);
    EXPECT_EQ(held.depth->raw, depth);
    EXPECT_EQ(held.color->bytes, color);
}

TEST(SyntheticSource, PlaysThreeHundredFramesAndSaysItEnded) {
    auto created = SyntheticSource::create(make_scene(Motion::idle, 320, 240));
    ASSERT_TRUE(created);
    Source& source = **created;
    ASSERT_TRUE(source.subscribe({0, StreamKind::bodies}));
    Timeline& line = *source.timeline();
    EXPECT_EQ(line.frame_count(), 300);
    EXPECT_EQ(line.time_of(299) + line.last_frame_duration(), 10 * kNsPerSecond);
    for (int i = 0; i < 300; ++i) {
        auto set = source.next(0);
        ASSERT_TRUE(set && *set);
        EXPECT_EQ((*set)->index, i);
        EXPECT_EQ((*set)->time, line.time_of(i));
        EXPECT_FALSE((*set)->depth);  // not subscribed, not made
        EXPECT_FALSE((*set)->color);
        EXPECT_TRUE((*set)->bodies);
        if (i > 0) {
            EXPECT_GT(line.time_of(i), line.time_of(i - 1));
        }
    }
    auto end = source.next(0);
    ASSERT_TRUE(end);
    EXPECT_FALSE(*end);
    const auto events = source.take_events();
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0].kind, EventKind::started);
    EXPECT_EQ(events[1].kind, EventKind::ended);
    EXPECT_FALSE(line.seek(300));
    EXPECT_FALSE(line.seek(-1));
    EXPECT_TRUE(line.seek(299));
    EXPECT_EQ(line.position(), 299);
}

TEST(SyntheticSource, RefusesStreamsItHasNot) {
    const auto source = make(Motion::idle);
    EXPECT_FALSE(source->subscribe({0, StreamKind::infrared}));
    EXPECT_FALSE(source->subscribe({1, StreamKind::depth}));
    source->unsubscribe({0, StreamKind::infrared});
    source->unsubscribe({0, StreamKind::color});
    EXPECT_FALSE(frame_at(*source, 0).color);
}

TEST(SyntheticSource, SaysWhereItStandsAndWhatItIs) {
    const auto source = make(Motion::idle);
    const FrameSet set = frame_at(*source, 0);
    EXPECT_EQ(set.pose_origin, PoseOrigin::floor);
    EXPECT_TRUE(is_valid(set.world_from_depth));
    EXPECT_NEAR(set.world_from_depth.translation.y, 1.05, 1e-9);
    EXPECT_EQ(set.depth->unit, DepthUnit::kinect_disparity11);
    EXPECT_EQ(set.color->format, PixelFormat::rgba8);
    EXPECT_TRUE(set.color_paired);
    EXPECT_TRUE(validate(*source->calibration()));
    EXPECT_EQ(source->info().streams.size(), 3u);
}

TEST(SyntheticUri, ReadsMotionSizeAndNoise) {
    const auto plain = parse_synthetic_uri("synthetic:");
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->motion, Motion::dance);
    EXPECT_EQ(plain->width, 640);
    EXPECT_TRUE(plain->noise);
    const auto full = parse_synthetic_uri("synthetic:wave?noise=off&size=320x240");
    ASSERT_TRUE(full);
    EXPECT_EQ(full->motion, Motion::wave);
    EXPECT_EQ(full->height, 240);
    EXPECT_FALSE(full->noise);
}

TEST(SyntheticUri, WrongOnesAreErrorsThatListTheChoices) {
    const auto error = [](const char* uri) {
        const auto result = parse_synthetic_uri(uri);
        EXPECT_FALSE(result) << uri;
        return result ? std::string() : result.error().to_string();
    };
    const std::string unknown = error("synthetic:moonwalk");
    EXPECT_THAT(unknown, HasSubstr("moonwalk"));
    for (const Motion motion : all_motions()) {
        EXPECT_THAT(unknown, HasSubstr(std::string(motion_name(motion))));
    }
    EXPECT_THAT(error("synthetic:wave?size=1x1"), HasSubstr("640x480"));
    EXPECT_THAT(error("synthetic:wave?noise=maybe"), HasSubstr("on|off"));
    EXPECT_THAT(error("synthetic:wave?colour=no"), HasSubstr("options"));
    EXPECT_THAT(error("synthetic:wave?noise"), HasSubstr("on|off"));
}

TEST(SyntheticUri, RegistersWithTheOthers) {
    register_synthetic_source();
    EXPECT_TRUE(open_source("synthetic:tpose?size=320x240"));
    const auto unknown = open_source("synthetic:nothing");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().to_string(), HasSubstr("dance"));
}

TEST(SyntheticSource, RefusesScenesThatCannotBe) {
    SyntheticScene scene = make_scene(Motion::idle);
    scene.world_from_depth.rotation.w = std::nan("");
    EXPECT_FALSE(SyntheticSource::create(scene));
    scene = make_scene(Motion::idle);
    scene.rig.depth.width = 642;
    EXPECT_FALSE(SyntheticSource::create(scene));
    scene = make_scene(Motion::idle);
    scene.rig.color->fx = 0;
    EXPECT_FALSE(SyntheticSource::create(scene));
}

class EveryScene : public testing::TestWithParam<Motion> {};
INSTANTIATE_TEST_SUITE_P(Motions, EveryScene, testing::ValuesIn(all_motions()),
                         [](const auto& test) { return std::string(motion_name(test.param)); });

TEST_P(EveryScene, TrackedJointsLieBehindTheBodysSurfaceAndInferredOnesBehindFurniture) {
    const SyntheticScene scene = make_scene(GetParam(), 320, 240);
    const Projection projection(scene.rig.depth);
    const glm::dvec3 eye = scene.world_from_depth.translation;
    const auto furniture = static_cast<std::int32_t>(scene.furniture.size());
    int tracked = 0;
    for (const int frame : {0, 37, 75, 112, 150, 201, 255}) {
        const reference::RaycastWorld world = reference::raycast_world(scene, frame / 30.0);
        const std::vector<Body> bodies = scene.bodies_at(frame / 30.0);
        ASSERT_EQ(bodies.size(), 1u);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            SCOPED_TRACE(testing::Message()
                         << joint_name(static_cast<Joint>(j)) << " in frame " << frame);
            const JointPosition& joint = bodies[0].joints[j];
            const glm::dvec3 seen(joint.position_m);
            const auto pixel = projection.project(seen);
            ASSERT_TRUE(pixel);
            const glm::dvec3 line = scene.world_from_depth.rotation * seen;
            const reference::RayHit first = reference::cast_ray(world, eye, line);
            if (joint.state == JointState::tracked) {
                ++tracked;
                EXPECT_GE(first.id, furniture + 6) << "the first surface is the body's";
                EXPECT_LE(first.t, 1.005);
                EXPECT_TRUE(pixel->x > -0.51 && pixel->y > -0.51 && pixel->x < 319.51 &&
                            pixel->y < 239.51);
            } else if (pixel->x > -0.5 && pixel->y > -0.5 && pixel->x < 319.5 && pixel->y < 239.5) {
                bool hidden = false;
                for (std::size_t i = 0; i < scene.furniture.size(); ++i) {
                    hidden = hidden || reference::enter_solid(world.solids[i], world.to_local[i],
                                                              eye, line, 0) < 1;
                }
                EXPECT_TRUE(hidden);
            }
        }
    }
    EXPECT_GT(tracked, 100);
}

TEST(SyntheticTruth, WalkingBehindTheTableHidesLegs) {
    const auto source = make(Motion::walk);
    int hidden = 0, table = 0;
    for (std::int64_t frame = 0; frame < 300; frame += 10) {
        const SyntheticTruth truth = source->truth(frame);
        for (const JointPosition& joint : truth.bodies.bodies[0].joints) {
            hidden += joint.state == JointState::inferred;
        }
        for (const PartId part : truth.part.pixels()) table += part == kPartTable;
    }
    EXPECT_GT(hidden, 20);
    EXPECT_LT(hidden, 300);
    EXPECT_GT(table, 1000);
}

TEST(SyntheticTruth, EveryPixelHasAKnownPartAndTheWholeBodyShows) {
    const auto source = make(Motion::tpose);
    const SyntheticTruth truth = source->truth(0);
    std::array<int, 256> count{};
    for (const PartId part : truth.part.pixels()) ++count[part];
    EXPECT_EQ(count[kPartNone], 0);
    for (int part = 1; part <= 20; ++part) {
        // Hip joints, ankles and the like own small pieces, yet every one owns some.
        const bool hidden_by_others = part - 1 == static_cast<int>(Joint::wrist_left) ||
                                      part - 1 == static_cast<int>(Joint::wrist_right);
        EXPECT_GT(count[static_cast<std::size_t>(part)], hidden_by_others ? 0 : 5)
            << joint_name(static_cast<Joint>(part - 1));
    }
    for (const PartId part : {kPartFloor, kPartBackWall, kPartTable, kPartChair, kPartShelf,
                              kPartThing, kPartLamp, kPartPlant}) {
        EXPECT_GT(count[part], 50) << int{part};
    }
}

TEST(SyntheticTruth, ReadingsAreTheTruthWithinNoise) {
    const auto source = make(Motion::dance);
    const FrameSet set = frame_at(*source, 60);
    const SyntheticTruth truth = source->truth(60);
    const Disparity disparity(source->scene().rig.disparity, 0.4, 8.0);
    std::size_t read = 0;
    for (std::size_t i = 0; i < truth.part.size(); ++i) {
        const std::uint16_t raw = set.depth->raw.pixels()[i];
        if (raw == Disparity::kNoReading) continue;
        ++read;
        const double z = static_cast<double>(truth.depth_m.pixels()[i]);
        ASSERT_NEAR(disparity.table()[raw], z, 2.4 * disparity.step_m(z));
        ASSERT_TRUE(truth.lit.pixels()[i]);
    }
    EXPECT_GT(read, truth.part.size() * 9 / 10);
}

TEST(ColorSensor, SeesAPointWhereItsDistortionPutsIt) {
    // Small red balls towards the corners, where distortion moves them by pixels.
    SyntheticScene scene = make_scene(Motion::idle);
    scene.person = false;
    const Pose color_from_world = scene.rig.color_from_depth * inverse(scene.world_from_depth);
    const Projection projection(*scene.rig.color);
    CameraModel straight = *scene.rig.color;
    straight.k1 = straight.k2 = straight.p1 = straight.p2 = 0;
    double largest_move = 0;
    for (const glm::dvec2 ray : {glm::dvec2(-0.5, -0.35), {0.5, -0.38}, {-0.48, 0.3}, {0.0, 0.0}}) {
        const glm::dvec3 seen = glm::dvec3(ray, 1) * 1.2;
        const glm::dvec3 place = inverse(color_from_world) * seen;
        scene.furniture = {
            ellipsoid(place, glm::dmat3(1), glm::dvec3(0.015), kPartThing, Covering::red)};
        ColorSensor sensor(scene);
        std::vector<std::uint32_t> rgba(640 * 480);
        sensor.draw({}, nullptr, rgba);
        glm::dvec2 sum(0);
        double count = 0;
        for (int y = 0; y < 480; ++y) {
            for (int x = 0; x < 640; ++x) {
                const std::uint32_t c =
                    rgba[static_cast<std::size_t>(y) * 640 + static_cast<std::size_t>(x)];
                if ((c & 255) < 3 * ((c >> 8) & 255)) continue;  // little green: the red ball
                sum += glm::dvec2(x, y);
                ++count;
            }
        }
        ASSERT_GT(count, 50);
        const glm::dvec2 expected = *projection.project(seen);
        EXPECT_NEAR(sum.x / count, expected.x, 0.35);
        EXPECT_NEAR(sum.y / count, expected.y, 0.35);
        largest_move =
            std::max(largest_move, glm::length(expected - *Projection(straight).project(seen)));
    }
    EXPECT_GT(largest_move, 2.0);
}

TEST(ColorSensor, DarkensTheFloorUnderTheFeetAndNothingElse) {
    const SyntheticScene scene = make_scene(Motion::idle, 320, 240);
    ColorSensor sensor(scene);
    std::vector<Primitive> person;
    scene.person_at(0, person);
    const std::vector<Body> bodies = scene.bodies_at(0);
    std::vector<std::uint32_t> plain(320 * 240), spotted(320 * 240);
    sensor.draw(person, nullptr, plain);
    sensor.draw(person, &bodies.front(), spotted);
    const Visibility& seen = sensor.visibility();
    const Projection projection(*scene.rig.color);
    const auto foot = projection.project(scene.rig.color_from_depth *
                                         glm::dvec3(bodies[0][Joint::foot_left].position_m));
    ASSERT_TRUE(foot);
    int darker_near = 0;
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            const auto i = static_cast<std::size_t>(y) * 320 + static_cast<std::size_t>(x);
            const bool floor = seen.part_of(seen.id().at(x, y)) == kPartFloor;
            if (!floor) {
                ASSERT_EQ(plain[i], spotted[i]);
            }
            for (int shift = 0; shift < 24; shift += 8) {
                ASSERT_LE((spotted[i] >> shift) & 255, (plain[i] >> shift) & 255);
            }
            const double away = glm::length(glm::dvec2(x, y) - *foot);
            darker_near += floor && away < 15 && (spotted[i] & 255) * 4 < (plain[i] & 255) * 3;
        }
    }
    EXPECT_GT(darker_near, 20);
}

TEST(SyntheticSource, EveryFrameHasItsSpotsUnderThePerson) {
    const auto source = make(Motion::walk);
    const SyntheticScene& scene = source->scene();
    ColorSensor sensor(scene);
    std::vector<Primitive> person;
    std::vector<std::uint32_t> rgba(320 * 240);
    for (const int frame : {4, 5, 150}) {
        scene.person_at(frame / 30.0, person);
        const std::vector<Body> bodies = scene.bodies_at(frame / 30.0);
        sensor.draw(person, &bodies.front(), rgba);
        const FrameSet set = frame_at(*source, frame);
        EXPECT_EQ(std::memcmp(set.color->bytes.data(), rgba.data(), set.color->bytes.size()), 0);
    }
}

TEST(ColorSensor, SeesTheSameSurfacesAsTheDepthCameraFromItsOwnPlace) {
    const auto source = make(Motion::dance, 640, 480);
    const SyntheticScene& scene = source->scene();
    const SyntheticTruth truth = source->truth(90);
    ColorSensor sensor(scene);
    std::vector<Primitive> person;
    scene.person_at(3.0, person);
    std::vector<std::uint32_t> rgba(640 * 480);
    sensor.draw(person, nullptr, rgba);
    const Visibility& seen = sensor.visibility();
    const Projection depth(scene.rig.depth), color(*scene.rig.color);
    int same = 0, asked = 0;
    for (int y = 4; y < 476; y += 3) {
        for (int x = 4; x < 636; x += 3) {
            const glm::dvec2 ray = *depth.unproject({x, y});
            const glm::dvec3 point =
                scene.rig.color_from_depth *
                (glm::dvec3(ray, 1) * static_cast<double>(truth.depth_m.at(x, y)));
            const auto pixel = color.project(point);
            if (!pixel) continue;
            const int u = static_cast<int>(std::lround(pixel->x));
            const int v = static_cast<int>(std::lround(pixel->y));
            if (!seen.id().contains(u, v)) continue;
            // Hidden from there, or an edge: only what both see counts.
            const double apart = std::abs(static_cast<double>(seen.z_m().at(u, v)) - point.z);
            if (apart > 0.02) continue;
            ++asked;
            same += seen.part_of(seen.id().at(u, v)) == truth.part.at(x, y);
        }
    }
    EXPECT_GT(asked, 28000);
    EXPECT_GT(same, asked * 99 / 100);
}

}  // namespace
}  // namespace kino
