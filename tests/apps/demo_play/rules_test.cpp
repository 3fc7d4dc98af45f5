#include "apps/demo/act.h"
#include "apps/demo/turntable.h"
#include "skeleton/gestures/gesture_recognizer.h"
#include "skeleton/synthetic/performance.h"
#include "tests/apps/demo_play/play_fixture.h"

namespace kino::test {
namespace {

using K = GestureKind;
using testing::ElementsAre;

TEST(Rules, PhasesFollowPeopleAndTheirWave) {
    Game game;
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    game.nobody(0.5);
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    game.go_on(0.1);
    EXPECT_EQ(game.play().phase(), DemoPhase::invite);
    game.make(K::wave);  // the recogniser tells of the wave before it says what came of it
    EXPECT_EQ(game.play().phase(), DemoPhase::invite);
    game.make(K::engaged);
    EXPECT_EQ(game.play().phase(), DemoPhase::playing);
    game.lost = true;
    game.nobody(5);
    EXPECT_EQ(game.play().phase(), DemoPhase::lost);
    game.lost = false;
    game.go_on(0.1);
    EXPECT_EQ(game.play().phase(), DemoPhase::playing);
    game.step({}, {gesture(K::released)});
    EXPECT_EQ(game.play().phase(), DemoPhase::invite);
    game.nobody(2);
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    EXPECT_THAT(game.said(),
                ElementsAre("visitor", "engaged", "lost", "back", "released", "alone"));
}

TEST(Rules, WhoIsGoneForLongPlaysNoMoreThoughNobodySaidSo) {
    Game game;
    game.engage();
    game.nobody(1);
    EXPECT_EQ(game.play().phase(), DemoPhase::playing);
    game.nobody(3);
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    EXPECT_THAT(game.said(), ElementsAre("visitor", "engaged", "left", "alone"));
}

TEST(Rules, OnlyWhoWavedPaintsAndLeadsWhatTheSceneHasForPeople) {
    Game game({.scenes = {"glass"}});
    game.go_on(2);
    const std::size_t shown = game.play().scene().meshes.size();
    EXPECT_EQ(painted(game.play().scene()), 0u);
    EXPECT_GE(game.play().local_lights(), kJointCount);  // soft ones at the joints
    game.make(K::engaged);
    game.go_on(2);
    EXPECT_GT(painted(game.play().scene()), 20u);
    EXPECT_GT(game.play().scene().meshes.size(), shown + painted(game.play().scene()));
    // Strokes end at the hands.
    const Body now = somebody(1, game.now_s());
    const BodyFrame frame{.bodies = {now}};
    game.step({now});
    double nearest = 1e9;
    for (const Light& light : game.play().scene().lights) {
        glm::dvec3 hand(now[Joint::hand_right].position_m);
        hand.x = -hand.x;  // the demo is a mirror
        nearest = std::min(nearest, glm::distance(light.position, sensor_pose() * hand));
    }
    EXPECT_LT(nearest, 0.13);
}

TEST(Rules, EveryGestureChangesWhatIsSeenInItsVeryMoment) {
    for (const K kind :
         {K::swipe_left, K::swipe_right, K::push, K::raise, K::raise_both, K::wave}) {
        Game with, without;
        for (Game* game : {&with, &without}) {
            game->engage();
            game->go_on(3);
        }
        ASSERT_EQ(bits_of(with.play().scene()), bits_of(without.play().scene()));
        with.make(kind);
        without.make(K::dwell);
        const Scene &a = with.play().scene(), &b = without.play().scene();
        const double light = glm::length(light_of_all(a)) * a.exposure;
        const double before = glm::length(light_of_all(b)) * b.exposure;
        const bool more = a.meshes.size() > b.meshes.size();
        EXPECT_TRUE(std::abs(light - before) > 0.02 * before || more) << gesture_name(kind);
    }
}

TEST(Rules, AHostsKeyChangesTheSceneThoughNobodyIsThere) {
    Game game;
    game.nobody(1);
    const std::string before = game.play().scene_name();
    game.play().next_scene();
    game.nobody(2);
    EXPECT_NE(game.play().scene_name(), before);
    EXPECT_THAT(game.said(), ElementsAre("scene"));
}

TEST(Rules, SwipesChangeTheSceneBehindTheCurtain) {
    Game game;
    game.engage();
    const std::string first = game.play().scene_name();
    const float whole = game.play().scene().exposure;
    game.step({somebody(1, game.now_s())}, {gesture(K::swipe_left)}, 0);
    EXPECT_LT(game.play().scene().exposure, 0.85f * whole);  // at once, whatever the clock does
    EXPECT_EQ(game.play().scene_name(), first);
    float last = game.play().scene().exposure;
    double took = kStep;
    int warmed = 0;
    std::string second = first;
    while (took < 3) {
        game.go_on(kStep);
        took += kStep;
        const Scene& scene = game.play().scene();
        if (game.play().scene_name() != second) {
            second = game.play().scene_name();
            EXPECT_LT(scene.exposure, 0.01f * whole);  // nobody sees it
            EXPECT_LT(scene.background_top.x, 0.01f);
        }
        if (const Scene* warm = game.play().scene_to_warm()) {
            ++warmed;
            EXPECT_LT(scene.exposure, 0.01f * whole);
            EXPECT_GT(warm->exposure, 0.5f);
            EXPECT_EQ(warm->meshes.size(), scene.meshes.size());
            EXPECT_EQ(game.play().scene_to_warm(), nullptr);
        }
        if (second != first && scene.exposure >= 1) break;
        if (second == first) {
            EXPECT_LT(scene.exposure, last + 1e-6f);
        }
        last = scene.exposure;
    }
    EXPECT_EQ(warmed, 1);
    EXPECT_LT(took, 0.9);
    EXPECT_GT(took, 0.4);
    game.make(K::swipe_right);
    game.go_on(1);
    EXPECT_EQ(game.play().scene_name(), first);
    // Once round, and two at once.
    for (int i = 0; i < 5; ++i) {
        game.make(K::swipe_left);
        game.go_on(0.9);
    }
    EXPECT_EQ(game.play().scene_name(), first);
    game.make(K::swipe_left);
    game.make(K::swipe_right);
    game.go_on(1);
    EXPECT_EQ(game.play().scene_name(), first);
    EXPECT_GE(game.play().scene().exposure, 1);
}

TEST(Rules, SwipesUpAndDownChangeColours) {
    Game game;
    game.engage();
    game.go_on(2);
    const glm::dvec3 before = light_of_all(game.play().scene());
    game.make(K::swipe_up);  // embers
    game.go_on(0.8);
    const glm::dvec3 embers = light_of_all(game.play().scene());
    EXPECT_GT(embers.x / embers.z, 3 * before.x / before.z);
    const std::size_t beads = 20;
    float blue = 0;
    for (std::size_t i = 0; i < beads; ++i) blue += game.play().scene().materials[i].emission.z;
    game.make(K::swipe_down);
    game.make(K::swipe_down);  // round to the last
    game.go_on(0.8);
    const glm::dvec3 last = light_of_all(game.play().scene());
    EXPECT_LT(last.x / last.z, 0.5 * embers.x / embers.z);
    EXPECT_EQ(game.log().back().what, "palette");
    game.make(K::swipe_up);
    game.go_on(0.8);
    const glm::dvec3 again = light_of_all(game.play().scene());
    EXPECT_NEAR(again.x / again.z, before.x / before.z, 0.25 * before.x / before.z);
}

TEST(Rules, APushThrowsALightThatFallsBouncesAndGoesOut) {
    Game game({.scenes = {"playroom"}});
    game.engage();
    game.make(K::push);
    const auto ball = [&]() -> std::optional<glm::dvec3> {
        for (const MeshNode& node : game.play().scene().meshes) {
            if (node.id >= kBallId && node.id < kAvatarId) return node.world_from_object[3];
        }
        return std::nullopt;
    };
    ASSERT_TRUE(ball().has_value());
    glm::dvec3 hand(somebody(1, game.now_s())[Joint::hand_right].position_m);
    hand.x = -hand.x;
    EXPECT_LT(glm::distance(*ball(), sensor_pose() * hand), 0.5);
    const glm::dvec3 at = *ball();
    double reach = 0;
    for (const Light& light : game.play().scene().lights) {
        if (glm::distance(light.position, at) < 1e-6) reach = light.radius_m;
    }
    EXPECT_GT(reach, 1);  // it carries a light
    double low = 1e9, last = ball()->y;
    bool rose = false;
    for (int i = 0; i < 60; ++i) {
        game.go_on(kStep);
        rose = rose || (ball()->y > last + 0.02 && low < 0.3 + sensor_pose().translation.y);
        last = ball()->y;
        low = std::min(low, last);
    }
    EXPECT_TRUE(rose);
    game.go_on(7);
    EXPECT_FALSE(ball().has_value());
    for (int i = 0; i < 60; ++i) game.make(K::push);
    EXPECT_EQ(balls(game.play().scene()), 48u);
    EXPECT_LE(game.play().local_lights(), 1024u + 48u);
}

TEST(Rules, PushesFlyWhereTheHandWent) {
    for (const glm::dvec3 way :
         {glm::dvec3(0, 0, -1), glm::dvec3(0.7, 0, -0.7), glm::dvec3(-0.7, -0.2, -0.7)}) {
        Game game({.mirror = false});
        game.engage();
        Body body = somebody(1, 0);
        const glm::dvec3 from(body[Joint::hand_right].position_m);
        for (int i = 0; i < 20; ++i) game.step({body});
        for (int i = 0; i <= 9; ++i) {
            body[Joint::hand_right].position_m = from + 0.055 * i * way;
            game.step({body}, i < 9 ? std::vector<GestureEvent>() : std::vector{gesture(K::push)});
        }
        const auto where = [&]() {
            for (const MeshNode& node : game.play().scene().meshes) {
                if (node.id >= kBallId) return glm::dvec3(node.world_from_object[3]);
            }
            ADD_FAILURE() << "no ball";
            return glm::dvec3(0);
        };
        const glm::dvec3 a = where();
        game.step({body});
        const glm::dvec3 flew = inverse(sensor_pose()).rotation * (where() - a);
        EXPECT_GT(glm::dot(glm::normalize(flew), glm::normalize(way)), 0.9);
        EXPECT_GT(glm::length(flew) / kStep, 3);
        EXPECT_LT(glm::length(flew) / kStep, 9);
    }
}

TEST(Rules, BothHandsUpClearWithABurst) {
    Game game;
    game.engage();
    game.go_on(4);
    game.make(K::push);
    const std::size_t strokes = painted(game.play().scene());
    ASSERT_GT(strokes, 40u);
    game.make(K::raise_both);
    EXPECT_LE(painted(game.play().scene()), 2u);
    EXPECT_EQ(balls(game.play().scene()), 0u);
    EXPECT_GE(sparks(game.play().scene()), strokes);
    EXPECT_GT(game.play().scene().exposure, 1.3f);
    game.go_on(0.8);
    EXPECT_EQ(sparks(game.play().scene()), 0u);
    EXPECT_EQ(game.play().scene().exposure, 1);
    EXPECT_EQ(game.log().back().what, "clear");
}

TEST(Rules, TwoHandsTurnAndZoomWithinLimitsAndATPoseStraightens) {
    Game game;
    game.engage();
    const auto hands = [&](K kind, double value) {
        GestureEvent event = gesture(kind, 1, Hand::both);
        event.phase = GesturePhase::begin;
        event.value = kind == K::zoom ? 1 : 0;
        game.make(event);
        event.phase = GesturePhase::change;
        event.value = value;
        game.make(event);
        game.go_on(1);
        event.phase = GesturePhase::end;
        game.make(event);
    };
    const auto player = [&] {
        glm::dvec3 at(somebody(1, 0)[Joint::hip_center].position_m);
        return sensor_pose() * at;
    };
    const auto eye = [&] { return game.play().view(160, 90).world_from_view.translation; };
    const glm::dvec3 before = eye();
    hands(K::rotate, 0.5);
    const glm::dvec3 turned = eye();
    EXPECT_GT(glm::distance(turned, before), 0.8);
    // About the player, at the same height.
    const auto level = [](glm::dvec3 v) { return std::hypot(v.x, v.z); };
    EXPECT_NEAR(level(turned - player()), level(before - player()), 0.15);
    EXPECT_NEAR(turned.y, before.y, 1e-6);
    hands(K::rotate, 100);
    const glm::dvec3 far = eye();
    hands(K::rotate, 1);
    EXPECT_LT(glm::distance(eye(), far), 1e-2);  // a limit
    game.make(K::t_pose, Hand::both);
    game.go_on(2.5);
    EXPECT_LT(glm::distance(eye(), before), 0.03);
    hands(K::zoom, 1.5);
    EXPECT_LT(glm::distance(eye(), player()), glm::distance(before, player()) - 0.6);
    hands(K::zoom, 1e9);
    EXPECT_GT(glm::distance(eye(), player()), 0.8);
    game.make(K::t_pose, Hand::both);
    game.go_on(2.5);
    EXPECT_LT(glm::distance(eye(), before), 0.03);
    EXPECT_THAT(game.said(), ElementsAre("visitor", "engaged", "turn", "turn", "turn", "view",
                                         "zoom", "zoom", "view"));
}

TEST(Rules, NothingStandsBetweenACameraThatTurnsAndWhatItLooksAt) {
    for (const std::string& name : demo::acts_or_default({})) {
        const auto act = demo::open_act(name, 0);
        ASSERT_TRUE(act.has_value());
        demo::Turntable turntable;
        const SceneCamera& camera = act->director->file().camera;
        GestureEvent turn = gesture(K::rotate, 1, Hand::both);
        turn.phase = GesturePhase::begin;
        turntable.hear(turn, true);
        turn.phase = GesturePhase::change;
        double fastest = 0;
        glm::dvec3 last = turntable.look(camera, act->room).eye_m;
        for (int i = 0; i < 400; ++i) {
            turn.value = 1.1 * std::sin(0.05 * i);
            turntable.hear(turn, true);
            turntable.step(kStep, std::nullopt, false, {camera, act->room, act->solids});
            const demo::Turntable::Look look = turntable.look(camera, act->room);
            fastest = std::max(fastest, glm::distance(look.eye_m, last));
            last = look.eye_m;
            for (const demo::Solid& solid : act->solids) {
                if (solid.screen) continue;
                // Within reach of the player, and what the scene's own camera looks past, is none.
                for (double part = 0.3; part <= 1; part += 0.02) {
                    const glm::dvec3 at = glm::mix(look.target_m, look.eye_m, part);
                    const glm::dvec3 own = glm::mix(camera.target_m, camera.eye_m, part);
                    if (touch(solid, own, 0.6) || solid.kind == demo::SolidKind::half_space) break;
                    ASSERT_FALSE(touch(solid, at, 0.1)) << name << " " << i << " " << part;
                }
            }
        }
        EXPECT_LT(fastest, 2.5) << name;
    }
}

TEST(Rules, TheCameraWandersOnlyWhileNobodyIsThere) {
    Game game;
    game.nobody(1);
    const auto eye = [&] { return game.play().view(160, 90).world_from_view.translation; };
    glm::dvec3 last = eye();
    double way = 0, fastest = 0;
    for (int i = 0; i < 300; ++i) {
        game.nobody(kStep);
        way += glm::distance(eye(), last);
        fastest = std::max(fastest, glm::distance(eye(), last) / kStep);
        last = eye();
    }
    EXPECT_GT(way, 0.5);
    EXPECT_LT(fastest, 1);
    game.engage();
    game.go_on(3);
    last = eye();
    game.go_on(2);
    EXPECT_LT(glm::distance(eye(), last), 0.02);
}

TEST(Rules, ASecondPersonPaintsInOtherColoursButDoesNotLead) {
    Game game({.scenes = {"torch", "glass"}});
    const auto two = [&](double seconds, std::vector<GestureEvent> events = {}) {
        for (int i = 0; i < static_cast<int>(seconds / kStep); ++i) {
            game.step({somebody(1, game.now_s(), -0.4), somebody(2, game.now_s(), 0.5)},
                      std::exchange(events, {}));
        }
    };
    two(0.3);
    two(0.1, {gesture(K::engaged, 1)});
    two(2);
    const std::size_t one = painted(game.play().scene());
    EXPECT_EQ(game.play().second_guidance(), nullptr);
    two(0.1, {gesture(K::wave, 2)});
    two(2);
    EXPECT_GT(painted(game.play().scene()), one + 30);
    std::set<std::uint32_t> looks;
    for (const MeshNode& node : game.play().scene().meshes) {
        if (node.id >= kPaintId && node.id < kPaintId + 800) looks.insert(node.material);
    }
    EXPECT_GT(looks.size(), 4u);
    ASSERT_NE(game.play().second_guidance(), nullptr);
    const std::string name = game.play().scene_name();
    two(1.5, {gesture(K::swipe_left, 2)});
    EXPECT_EQ(game.play().scene_name(), name);
    two(0.1, {gesture(K::push, 2), gesture(K::swipe_up, 2)});
    EXPECT_EQ(balls(game.play().scene()), 1u);
    // A third finds no place; the second takes over when the recogniser says so.
    two(0.1, {gesture(K::wave, 3)});
    two(0.1, {gesture(K::released, 1), gesture(K::engaged, 2)});
    two(1.5, {gesture(K::swipe_left, 2)});
    EXPECT_NE(game.play().scene_name(), name);
    EXPECT_NE(game.play().second_guidance(), nullptr);
    // What they learned as the second they know as the first.
    EXPECT_THAT(game.play().guidance().hint,
                testing::AnyOf(DemoHint::two_hands, DemoHint::raise_both));
    EXPECT_THAT(game.said(), ElementsAre("visitor", "engaged", "joined", "throw", "palette", "full",
                                         "released", "engaged", "scene"));
}

TEST(Rules, TheLogOfAPerformanceIsItsScript) {
    // True joints of the performance through the recogniser.
    const SyntheticScene scene = make_performance(320, 240);
    auto play = DemoPlay::create({});
    ASSERT_TRUE(play.has_value());
    GestureRecognizer recognizer;
    std::vector<std::string> said;
    for (int i = 0; i < static_cast<int>(kPerformanceSeconds * 30); ++i) {
        BodyFrame frame{.time = from_seconds(i / 30.0), .bodies = scene.bodies_at(i / 30.0)};
        // Who is not seen at all is not there.
        std::erase_if(frame.bodies, [](const Body& body) {
            return std::none_of(body.joints.begin(), body.joints.end(), [](const auto& joint) {
                return joint.state == JointState::tracked;
            });
        });
        const auto gestures = recognizer.update(frame);
        play->step({.dt_s = 1 / 30.0,
                    .time = frame.time,
                    .bodies = &frame,
                    .gestures = gestures,
                    .world_from_depth = scene.world_from_depth});
        for (const DemoEvent& event : play->take_events()) {
            EXPECT_EQ(event.time, frame.time);
            said.push_back(event.what);
        }
    }
    // What each cue of the script is called here.
    std::vector<std::string> expected = {"visitor"};
    for (const Cue& cue : performance_script()) {
        const auto kind = gesture_from_name(cue.gesture);
        ASSERT_TRUE(kind.has_value()) << cue.gesture;
        if (cue.phase != "once" && cue.phase != "end") continue;
        switch (*kind) {
            case K::engaged:
                expected.push_back("engaged");
                break;
            case K::released:
                expected.push_back("released");
                break;
            case K::swipe_left:
            case K::swipe_right:
                expected.push_back("scene");
                break;
            case K::swipe_up:
            case K::swipe_down:
                expected.push_back("palette");
                break;
            case K::push:
                expected.push_back("throw");
                break;
            case K::raise:
                expected.push_back("fountain");
                break;
            case K::raise_both:
                expected.push_back("clear");
                break;
            case K::t_pose:
                expected.push_back("view");
                break;
            case K::zoom:
                expected.push_back("zoom");
                break;
            case K::rotate:
                expected.push_back("turn");
                break;
            case K::wave:  // before the game, it is told by what comes of it
                if (cue.time_s > 10) expected.push_back("wave");
                break;
            case K::dwell:
                expected.push_back("dwell");
                break;
            default:
                break;
        }
    }
    expected.push_back("alone");
    EXPECT_EQ(said, expected);
}

}  // namespace
}  // namespace kino::test
