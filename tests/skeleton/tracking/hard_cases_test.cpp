// The hard cases for joints, with the shipped forest and the whole tracker.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <set>

#include "tests/skeleton/tracking/eval/take.h"
#include "tests/skeleton/tracking/tracked_scene.h"

namespace kino {
namespace {

using glm::dvec3;
using namespace test;

constexpr std::size_t kHead = 3;

struct Outcome {
    std::vector<float> all, trunk, legs, visible;  // trunk: the four joints of the middle
    std::set<std::uint32_t> ids;
    int frames = 0, found = 0;
    bool finite = true;

    void add(const BodyFrame& frame, const Body& truth) {
        const Body* body = nearest_body(frame, truth);
        ++frames;
        found += body ? 1 : 0;
        if (body) ids.insert(body->id);
        finite = finite && all_finite(frame);
        for (const float e : errors_mm(truth, body)) all.push_back(e);
        for (const float e : errors_mm(truth, body, 0, kHead)) trunk.push_back(e);
        for (const float e : errors_mm(truth, body, 12, 19)) legs.push_back(e);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            if (truth.joints[j].state == JointState::tracked) {
                visible.push_back(errors_mm(truth, body, j, j)[0]);
            }
        }
    }
};

void report(const char* name, const Outcome& o) {
    ::testing::Test::RecordProperty(name, std::to_string(mean_of(o.all)));
    printf(
        "%s: found %d of %d, mean %.0f visible %.0f trunk %.0f legs %.0f, 90%% %.0f mm, ids %zu\n",
        name, o.found, o.frames, static_cast<double>(mean_of(o.all)),
        static_cast<double>(mean_of(o.visible)), static_cast<double>(mean_of(o.trunk)),
        static_cast<double>(mean_of(o.legs)), static_cast<double>(quantile_of(o.all, 0.9)),
        o.ids.size());
}

// A staged take; frames before `settle` play but do not count.
Outcome play(const std::string& motion, std::uint64_t seed, int count, int settle,
             std::optional<double> distance = {}, int every = 2) {
    ActorTake options;
    options.motion = motion;
    options.seed = seed;
    options.furniture = false;
    options.lead_in_s = 1;
    options.distance_m = distance;
    Result<Take> take = actor_take(options);
    EXPECT_TRUE(take);
    BodyTracker tracker = tracker_for(take->rays);
    Outcome outcome;
    TakeFrame frame;
    BodyFrame bodies;
    for (int i = 0; i < take->frames && outcome.frames < count; i += i < 30 ? 5 : every) {
        take->render(i, frame);
        tracker.track(frame.depth_m, frame.time, std::nullopt, bodies);
        if (i < 30 + settle || frame.truth.bodies.empty()) {
            EXPECT_TRUE(all_finite(bodies));
            continue;
        }
        outcome.add(bodies, frame.truth.bodies[0]);
    }
    report(motion.c_str(), outcome);
    EXPECT_TRUE(outcome.finite);
    return outcome;
}

// Somebody of the synthetic room who moves with `motion`, moved about by `place`.
template <class Place>
Outcome stage(const char* name, const RoomOptions& room, Place place, int count, double fps = 30,
              const BodyTrackerOptions& options = {}) {
    TrackedScene s(room, options);
    s.learn_room();
    s.step = static_cast<TimeNs>(1e9 / fps);
    Outcome outcome;
    const int settle = fps < 5 ? 2 : 8;
    for (int i = 0; i < count + settle; ++i) {
        const Actor actor = place(i / fps);
        s.next({actor});
        EXPECT_TRUE(all_finite(s.frame));
        if (i >= settle) outcome.add(s.frame, s.truth(actor));
    }
    report(name, outcome);
    EXPECT_TRUE(outcome.finite);
    return outcome;
}

Actor crossing_arms(double t) {
    Actor actor = actor_at(0, -2.4, Motion::idle, t);
    for (std::size_t side = 0; side < 2; ++side) {
        const double s = side == 0 ? 1 : -1;
        actor.pose.arm[side].upper = glm::normalize(dvec3(s * 0.25, -1, 0.35));
        actor.pose.arm[side].lower = glm::normalize(dvec3(-s, 0.12 + 0.05 * s, 0.35));
        actor.pose.arm[side].hand = glm::normalize(dvec3(-s, 0.1, -0.1));
    }
    return actor;
}

TEST(HardCases, EnteringAtTheBorder) {
    const Outcome o = play("enter", 4, 60, 0);
    EXPECT_GT(o.found, 3 * o.frames / 4);
    EXPECT_LT(mean_of(o.visible), 100);
}

TEST(HardCases, Sideways) {
    const Outcome o = play("sideways", 6, 40, 15);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.trunk), 120);
}

TEST(HardCases, BackToTheCamera) {
    const Outcome o = play("back", 6, 40, 15);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.trunk), 60);
    // Left is left: a swap would cost some 300 mm.
    EXPECT_LT(mean_of(o.all), 120);
}

TEST(HardCases, ArmsCrossed) {
    const Outcome o = stage("arms crossed", {}, crossing_arms, 30);
    EXPECT_LT(mean_of(o.all), 90);
    EXPECT_LT(mean_of(o.trunk), 60);
}

TEST(HardCases, Sitting) {
    const Outcome o = play("sit", 8, 40, 15);
    EXPECT_LT(mean_of(o.trunk), 60);
    EXPECT_LT(mean_of(o.all), 100);
}

TEST(HardCases, Lying) {
    // The trunk lies where it lies; arms are often wrong.
    const Outcome o = play("lie", 4, 30, 15);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.trunk), 120);
}

TEST(HardCases, Hugging) {
    const Outcome o = play("hug", 4, 40, 0);
    EXPECT_GT(o.found, 3 * o.frames / 4);
    EXPECT_LT(mean_of(o.visible), 120);
}

TEST(HardCases, Crossing) {
    const Outcome o = play("cross", 4, 50, 0);
    EXPECT_GT(o.found, 3 * o.frames / 4);
    EXPECT_LT(mean_of(o.visible), 140);
}

TEST(HardCases, HoldingALargeBox) {
    // The box counts as the person's body, so nothing is asked of the chest and arms behind it.
    const Outcome o = play("hold", 4, 30, 15);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.legs), 100);
}

TEST(HardCases, ASkirtLeavesTheUpperBodyRight) {
    // Knees and hips below it are guesses.
    const Outcome o = play("arms", 604, 20, 10, 2.6);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.trunk), 80);
    EXPECT_LT(mean_of(o.all), 150);
}

TEST(HardCases, AHandOnTheWall) {
    const Outcome o = play("wall", 4, 30, 15);
    EXPECT_LT(mean_of(o.trunk), 60);
    EXPECT_LT(mean_of(o.all), 80);
}

TEST(HardCases, HalfOutOfView) {
    RoomOptions room;
    const Outcome o = stage(
        "half out of view", room, [](double t) { return actor_at(1.2, -2.2, Motion::idle, t); },
        30);
    // The half that is seen; the other half is a guess, but a finite one.
    EXPECT_LT(quantile_of(o.all, 0.5), 150);
}

TEST(HardCases, SixtyCentimetresAway) {
    RoomOptions room;
    room.camera_height_m = 1.4;
    const Outcome o = stage(
        "0.6 m", room, [](double t) { return actor_at(0, -0.75, Motion::idle, t); }, 30);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.trunk), 120);
}

TEST(HardCases, FourAndAHalfMetresAway) {
    RoomOptions room;
    room.back_wall_m = 6.5;
    room.furniture = false;
    const Outcome o = stage(
        "4.5 m", room, [](double t) { return actor_at(0, -4.5, Motion::wave, t); }, 40);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_LT(mean_of(o.all), 70);
}

TEST(HardCases, TiltedThirtyDegrees) {
    RoomOptions room;
    room.tilt_deg = -30;
    room.camera_height_m = 2.3;
    room.furniture = false;
    const Outcome o = stage(
        "tilted 30 degrees", room, [](double t) { return actor_at(0, -2.6, Motion::raise, t); },
        40);
    EXPECT_LT(mean_of(o.all), 90);
}

TEST(HardCases, OneFrameASecond) {
    const Outcome o = stage(
        "1 fps", {}, [](double t) { return actor_at(0, -2.5, Motion::dance, t); }, 12, 1);
    EXPECT_LT(mean_of(o.all), 75);
}

TEST(HardCases, SixtyFramesASecond) {
    const Outcome o = stage(
        "60 fps", {}, [](double t) { return actor_at(0, -2.5, Motion::dance, t); }, 60, 60);
    EXPECT_LT(mean_of(o.all), 75);
}

TEST(HardCases, AnEmptyRoomForAMinuteHasNobody) {
    RoomOptions room;
    room.width = 160;
    room.height = 120;
    TrackedScene s(room);
    std::vector<Image<float>> pictures;
    for (std::uint64_t i = 0; i < 30; ++i) {
        s.scene.draw({}, i);
        pictures.push_back(s.scene.depth_m());
    }
    for (int i = 0; i < 1800; ++i) {
        s.time += s.step;
        s.tracker.track(pictures[static_cast<std::size_t>((i * 7) % 30)], s.time, std::nullopt,
                        s.frame);
        ASSERT_TRUE(s.frame.bodies.empty()) << i;
    }
}

TEST(HardCases, PicturesWithoutReadingsAndThoseOfNanHaveNoJointThatIsNotFinite) {
    TrackedScene s;
    s.learn_room();
    for (int i = 0; i < 15; ++i) s.next({actor_at(0, -2.4, Motion::wave, i / 30.0)});
    ASSERT_EQ(s.frame.bodies.size(), 1u);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float bad : {0.0f, nan, infinity, -infinity, -1.0f, 1e30f}) {
        Image<float> nothing(s.room.width, s.room.height, bad);
        s.time += s.step;
        s.tracker.track(nothing, s.time, std::nullopt, s.frame);
        EXPECT_TRUE(all_finite(s.frame)) << bad;
    }
    // Half of the pixels spoilt, the person among them.
    s.scene.draw(std::vector<Actor>{actor_at(0, -2.4, Motion::wave, 0.5)}, 99);
    Image<float> spoilt = s.scene.depth_m();
    for (std::size_t i = 0; i < spoilt.size(); i += 2) spoilt.data()[i] = i % 4 == 0 ? nan : 0;
    s.time += s.step;
    s.tracker.track(spoilt, s.time, std::nullopt, s.frame);
    EXPECT_TRUE(all_finite(s.frame));
    // He is back where he is.
    Actor actor = actor_at(0, -2.4, Motion::wave, 0.6);
    for (int i = 0; i < 20; ++i) s.next({actor});
    const Body truth = s.truth(actor);
    EXPECT_LT(mean_of(errors_mm(truth, nearest_body(s.frame, truth))), 80);
}

TEST(HardCases, SeatedModeHasTenJoints) {
    BodyTrackerOptions options;
    options.mode = TrackingMode::seated;
    TrackedScene s({}, options);
    s.learn_room();
    const Actor actor = actor_at(0, -2, Motion::wave, 1);
    for (int i = 0; i < 12; ++i) s.next({actor});
    ASSERT_EQ(s.frame.bodies.size(), 1u);
    int given = 0;
    for (const JointPosition& joint : s.frame.bodies[0].joints) {
        given += joint.state != JointState::lost ? 1 : 0;
    }
    EXPECT_EQ(given, 10);
    EXPECT_LT(mean_of(errors_mm(s.truth(actor), s.frame.bodies.data(), 2, 11)), 70);
}

TEST(Knobs, AShallowForestOfOneTreeStillTracks) {
    BodyTrackerOptions options;
    options.trees = 1;
    options.max_depth = 12;
    TrackedScene s({}, options), whole;
    const Actor actor = actor_at(0, -2.3, Motion::wave, 1);
    for (TrackedScene* scene : {&s, &whole}) {
        scene->learn_room();
        for (int i = 0; i < 12; ++i) scene->next({actor});
        ASSERT_EQ(scene->frame.bodies.size(), 1u);
    }
    const float with_less = mean_of(errors_mm(s.truth(actor), s.frame.bodies.data()));
    EXPECT_LT(with_less, 150);
    EXPECT_NE(with_less, mean_of(errors_mm(s.truth(actor), whole.frame.bodies.data())));
}

TEST(Knobs, ResetForgetsEverything) {
    TrackedScene a, b;
    a.learn_room();
    for (int i = 0; i < 10; ++i) a.next({actor_at(0.3, -2.3, Motion::dance, i / 30.0)});
    a.tracker.reset();
    a.time = 0;
    a.index = 0;
    a.learn_room();
    b.learn_room();
    for (int i = 0; i < 10; ++i) {
        const std::vector<Actor> actor = {actor_at(0, -2.4, Motion::wave, i / 30.0)};
        a.next(actor);
        b.next(actor);
    }
    ASSERT_EQ(a.frame.bodies.size(), 1u);
    ASSERT_EQ(b.frame.bodies.size(), 1u);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_EQ(a.frame.bodies[0].joints[j].position_m, b.frame.bodies[0].joints[j].position_m);
    }
}

TEST(Knobs, AForestOfOtherPartsIsRefused) {
    TrackedScene s;
    auto other = std::make_shared<Forest>();
    other->labels = {"left", "right"};
    const auto refused = BodyTracker::create(s.scene.rays(), other);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().what.find("labels"), std::string::npos);
}

TEST(HardCases, TheThirdPersonHasAPlaceOnly) {
    RoomOptions room;
    room.furniture = false;
    TrackedScene s(room);
    s.learn_room();
    const std::vector<Actor> three = {actor_at(-0.9, -2.7), actor_at(0, -2.7), actor_at(0.9, -2.7)};
    for (int i = 0; i < 15; ++i) s.next(three);
    ASSERT_EQ(s.frame.bodies.size(), 3u);
    int whole = 0, placed = 0;
    for (const Body& body : s.frame.bodies) {
        int given = 0;
        for (const JointPosition& joint : body.joints) {
            given += joint.state != JointState::lost ? 1 : 0;
        }
        whole += given == 20 ? 1 : 0;
        placed += given == 1 && body[Joint::hip_center].state == JointState::inferred ? 1 : 0;
    }
    EXPECT_EQ(whole, 2);
    EXPECT_EQ(placed, 1);
}

TEST(HardCases, TheSamePicturesGiveTheSameBits) {
    TrackedScene a, b;
    a.learn_room();
    b.learn_room();
    for (int i = 0; i < 20; ++i) {
        const std::vector<Actor> actor = {actor_at(0, -2.4, Motion::dance, i / 30.0)};
        a.next(actor);
        b.next(actor);
        ASSERT_EQ(a.frame.bodies.size(), b.frame.bodies.size());
        for (std::size_t k = 0; k < a.frame.bodies.size(); ++k) {
            for (std::size_t j = 0; j < kJointCount; ++j) {
                ASSERT_EQ(a.frame.bodies[k].joints[j].position_m,
                          b.frame.bodies[k].joints[j].position_m);
            }
        }
    }
}

TEST(HardCases, AStandingPersonIsStillAndAFastArmIsNotLate) {
    RoomOptions room;
    room.width = 640;
    room.height = 480;
    TrackedScene s(room);
    s.learn_room();
    const Actor still = actor_at(0, -2.0, Motion::idle, 0);
    std::array<std::vector<glm::vec3>, kJointCount> track;
    for (int i = 0; i < 160; ++i) {
        s.next({still});
        if (i < 100 || s.frame.bodies.size() != 1) continue;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            track[j].push_back(s.frame.bodies[0].joints[j].position_m);
        }
    }
    double sum = 0, worst = 0;
    const char* whose = "";
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const auto& joint = track[j];
        ASSERT_GT(joint.size(), 50u);
        glm::dvec3 mean(0);
        for (const glm::vec3& p : joint) mean += dvec3(p) / static_cast<double>(joint.size());
        double square = 0;
        for (const glm::vec3& p : joint) {
            const dvec3 d = dvec3(p) - mean;
            square += glm::dot(d, d) / static_cast<double>(joint.size());
        }
        sum += square;
        if (std::sqrt(square) > worst) {
            worst = std::sqrt(square);
            whose = joint_name(static_cast<Joint>(j));
        }
    }
    const double jitter_mm = 1000 * std::sqrt(sum / kJointCount);
    printf("jitter %.2f mm, worst: %s %.2f mm\n", jitter_mm, whose, 1000 * worst);
    EXPECT_LT(jitter_mm, 4);
    EXPECT_LT(1000 * worst, 4);
    // A fast arm: the time by which the hand's path has to be shifted to match best.
    std::vector<glm::vec3> found, truth;
    for (int i = 0; i < 75; ++i) {
        const Actor actor = actor_at(0, -2.0, Motion::swipe, i / 30.0);
        s.next({actor});
        const Body body = s.truth(actor);
        ASSERT_EQ(s.frame.bodies.size(), 1u);
        found.push_back(s.frame.bodies[0][Joint::hand_right].position_m);
        truth.push_back(body[Joint::hand_right].position_m);
    }
    double best = 1e9, lag_ms = 0;
    for (int shift = -20; shift <= 60; ++shift) {  // tenths of a frame
        double error = 0;
        for (std::size_t i = 20; i < found.size(); ++i) {
            const double at = static_cast<double>(i) - shift / 10.0;
            const auto k = static_cast<std::size_t>(at);
            if (k + 1 >= truth.size()) continue;
            const auto w = static_cast<float>(at - static_cast<double>(k));
            const glm::vec3 d = glm::mix(truth[k], truth[k + 1], w) - found[i];
            error += static_cast<double>(glm::dot(d, d));
        }
        if (error < best) {
            best = error;
            lag_ms = shift / 10.0 * 1000 / 30;
        }
    }
    printf("lag %.0f ms\n", lag_ms);
    EXPECT_LT(lag_ms, 50);
}

}  // namespace
}  // namespace kino
