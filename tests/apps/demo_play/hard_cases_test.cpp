#include <limits>

#include "apps/demo/mirrored.h"
#include "tests/apps/demo_play/play_fixture.h"
#include "tests/support/random.h"

namespace kino::test {
namespace {

using K = GestureKind;

constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

GestureEvent any_event(Random& random) {
    GestureEvent event{.kind = static_cast<K>(random.integer(0, 14)),
                       .phase = static_cast<GesturePhase>(random.integer(0, 3)),
                       .hand = static_cast<Hand>(random.integer(0, 3)),
                       .body_id = static_cast<std::uint32_t>(random.integer(0, 7)),
                       .primary = random.chance(0.5),
                       .confidence = 1};
    event.value = random.chance(0.1)   ? std::numeric_limits<double>::quiet_NaN()
                  : random.chance(0.1) ? 1e300
                                       : random.real(-3, 3);
    return event;
}

std::vector<Body> any_bodies(Random& random, double time_s) {
    std::vector<Body> bodies;
    const int count = random.integer(0, 6);
    for (int i = 0; i < count; ++i) {
        // Identities come, go, and swap places; some come twice.
        Body body = somebody(static_cast<std::uint32_t>(random.integer(0, 7)), time_s,
                             random.real(-1.5, 1.5), random.real(0.6, 4.5));
        for (JointPosition& joint : body.joints) {
            if (random.chance(0.1)) joint.state = JointState::lost;
            if (random.chance(0.04)) joint.position_m.x = kNanF;
            if (random.chance(0.04)) joint.position_m.y = 1e30f;
            if (random.chance(0.04)) joint.position_m = {0, 0, 0};
        }
        bodies.push_back(body);
    }
    return bodies;
}

/// Ruin by chance; the bits of all scenes.
std::string ruin(std::uint64_t seed, int moments, std::vector<std::string>* said = nullptr) {
    Random random(seed);
    Game game({.mirror = random.chance(0.5), .seed = seed});
    std::string bits;
    for (int i = 0; i < moments; ++i) {
        std::vector<GestureEvent> events;
        while (random.chance(0.25)) events.push_back(any_event(random));
        constexpr double kSteps[] = {
            1 / 30.0, 0, 10, 1 / 240.0, 0.1, -3, std::numeric_limits<double>::quiet_NaN()};
        const double dt = random.chance(0.7) ? kStep : kSteps[random.integer(0, 6)];
        if (random.chance(0.03)) game.lost = !game.lost;
        if (random.chance(0.01)) game.play().reset();
        game.step(any_bodies(random, game.now_s()), events, dt);
        if (random.chance(0.3)) (void)game.play().scene_to_warm();
        expect_sound(game.play());
        if (::testing::Test::HasFatalFailure()) return {};
        bits += bits_of(game.play().scene());
    }
    if (said != nullptr) *said = game.said();
    return std::to_string(std::hash<std::string>()(bits));
}

TEST(HardCases, RuinedJointsIdentitiesEventsAndClocks) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        ruin(seed, 250);
        if (HasFatalFailure()) FAIL() << seed;
    }
}

TEST(HardCases, TheSameMomentsGiveTheSameBits) {
    std::vector<std::string> first, second;
    EXPECT_EQ(ruin(9, 200, &first), ruin(9, 200, &second));
    EXPECT_EQ(first, second);
    EXPECT_NE(ruin(9, 60), ruin(10, 60));
}

TEST(HardCases, AfterResetEverythingIsAsNew) {
    const auto act = [](Game& game) {
        std::string bits;
        game.engage();
        for (const K kind : {K::push, K::swipe_up, K::raise, K::swipe_left, K::raise_both}) {
            game.make(kind);
            game.go_on(0.4);
            bits += bits_of(game.play().scene());
        }
        return bits;
    };
    Game fresh, used;
    ruin(5, 3);
    const std::string bits = act(fresh);
    used.engage();
    used.make(K::swipe_left);
    used.make(K::swipe_up);
    used.make(K::push);
    used.go_on(1);
    used.play().reset();
    EXPECT_EQ(used.play().phase(), DemoPhase::attract);
    // The hands of somebody() go by the time that has passed.
    Game late;
    late.nobody(used.now_s());
    late.play().reset();
    EXPECT_EQ(act(used), act(late));
    EXPECT_FALSE(bits.empty());
}

TEST(HardCases, AnEmptyRecording) {
    Game game;
    EXPECT_TRUE(game.play().view(64, 48).width == 64);
    expect_sound(game.play());  // before any moment
    game.play().step({});
    expect_sound(game.play());
    for (int i = 0; i < 100; ++i) game.play().step({.dt_s = 10});
    expect_sound(game.play());
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    EXPECT_GT(game.play().local_lights(), 800u);  // the swarm dances
    EXPECT_TRUE(game.play().take_events().empty());
}

TEST(HardCases, SixPeopleAndHoursOfPaintingStayWithinTheLights) {
    Game game;
    std::size_t most_lights = 0, most_nodes = 0;
    for (int i = 0; i < 900; ++i) {
        std::vector<Body> bodies;
        for (std::uint32_t id = 1; id <= 6; ++id) {
            bodies.push_back(somebody(id, 3 * game.now_s() + id, -1.8 + 0.6 * id));
        }
        std::vector<GestureEvent> events;
        if (i == 5) events = {gesture(K::engaged, 1)};
        if (i == 9) events = {gesture(K::wave, 2)};
        if (i % 20 == 0) events.push_back(gesture(K::push, 1 + i % 40 / 20));
        if (i % 300 == 150) events.push_back(gesture(K::raise_both, 1));
        game.step(bodies, events);
        if (i % 10 != 0) continue;
        expect_sound(game.play());
        ASSERT_FALSE(HasFatalFailure()) << i;
        const Scene& scene = game.play().scene();
        most_lights = std::max(most_lights, game.play().local_lights() - balls(scene));
        most_nodes = std::max(most_nodes, scene.meshes.size());
    }
    EXPECT_EQ(most_lights, 1024u);
    EXPECT_LT(most_nodes, 2400u);
    EXPECT_GT(painted(game.play().scene()), 200u);
}

TEST(HardCases, ABodyThatLeavesInTheMiddleOfATurn) {
    Game game;
    game.engage();
    GestureEvent event = gesture(K::rotate, 1, Hand::both);
    event.phase = GesturePhase::begin;
    game.make(event);
    event.phase = GesturePhase::change;
    event.value = 0.4;
    game.make(event);
    game.nobody(4);  // no end, no release
    EXPECT_EQ(game.play().phase(), DemoPhase::attract);
    game.nobody(3);
    const glm::dvec3 wandering = game.play().view(64, 48).world_from_view.translation;
    game.nobody(1);
    EXPECT_NE(game.play().view(64, 48).world_from_view.translation, wandering);
    event.phase = GesturePhase::end;
    game.step({}, {event});
    expect_sound(game.play());
}

TEST(HardCases, IdentitiesThatSwapDoNotJumpStrokesAcrossTheRoom) {
    Game game;
    for (int i = 0; i < 90; ++i) {
        const bool swapped = i >= 60;
        game.step({somebody(swapped ? 2 : 1, game.now_s(), -0.7),
                   somebody(swapped ? 1 : 2, game.now_s(), 0.7)},
                  i == 2 ? std::vector{gesture(K::engaged, 1)} : std::vector<GestureEvent>());
    }
    for (const MeshNode& node : game.play().scene().meshes) {
        if (node.id < kPaintId || node.id >= kPaintId + 800) continue;
        EXPECT_LT(glm::length(glm::dvec3(node.world_from_object[1])), 0.1);
    }
}

TEST(HardCases, UnknownScenesAndTooManyMaterialsAreErrors) {
    const auto play = DemoPlay::create({.scenes = {"light-painting", "disco"}});
    ASSERT_FALSE(play.has_value());
    EXPECT_THAT(play.error().to_string(), testing::HasSubstr("disco"));
}

TEST(Avatars, WithoutOneThereIsNothingOfThem) {
    Game game;
    game.nobody(3);
    game.engage();
    game.go_on(1);
    const Scene& scene = game.play().scene();
    EXPECT_EQ(nodes_within(scene, kAvatarId, 65536), 0u);
    for (const MeshNode& node : scene.meshes) EXPECT_EQ(node.pose, nullptr);
}

TEST(Avatars, StandForPeopleAndMoveAloneForNobody) {
    const auto rig = open_avatar("mannequin");
    ASSERT_TRUE(rig.has_value()) << rig.error().to_string();
    Game game({.avatar = *rig});
    game.nobody(3);
    EXPECT_EQ(nodes_within(game.play().scene(), kAvatarId, 65536), (*rig)->parts.size());
    game.engage();
    game.go_on(2);
    const Scene& scene = game.play().scene();
    EXPECT_EQ(nodes_within(scene, kAvatarId, 65536), (*rig)->parts.size());
    expect_sound(game.play());
    // It stands where the mirrored person is.
    glm::dvec3 hips(somebody(1, 0)[Joint::hip_center].position_m);
    hips.x = -hips.x;
    const glm::dvec3 at = sensor_pose() * hips;
    for (const MeshNode& node : scene.meshes) {
        if (node.id < kAvatarId) continue;
        EXPECT_LE(node.material, scene.materials.size());
        ASSERT_NE(node.pose, nullptr);
        const glm::dvec3 stands(node.world_from_object * glm::dmat4((*node.pose)[0]) *
                                glm::dvec4(0, 0, 0, 1));
        EXPECT_LT(std::hypot(stands.x - at.x, stands.z - at.z), 1.5);
    }
}

std::shared_ptr<DepthSurface> wall_and_person() {
    auto surface = std::make_shared<DepthSurface>();
    surface->depth_m = Image<float>(64, 48, 4.0f);
    auto rays = std::make_shared<Image<RayXy>>(64, 48);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            // Not symmetric: the middle of the picture is not its centre.
            rays->row(y)[x] = {static_cast<float>((x - 30.0) / 50),
                               static_cast<float>((y - 23.5) / 50)};
            if (x > 24 && x < 36) surface->depth_m.row(y)[x] = 2.5f;
        }
    }
    surface->rays = rays;
    surface->focal_px = 50;
    surface->version = 7;
    return surface;
}

TEST(LiveBody, IsCutOutMirroredAndOnlyThereWithPeople) {
    Game game, plain({.mirror = false}), none({.live_body = false});
    for (Game* one : {&game, &plain, &none}) {
        one->surface = wall_and_person();
        one->nobody(0.2);
        EXPECT_FALSE(one->play().scene().live.has_value());
        one->go_on(0.2);
    }
    EXPECT_FALSE(none.play().scene().live.has_value());
    const auto sum_of = [](Game& one) {
        glm::dvec3 sum(0);
        double count = 0;
        const auto& live = one.play().scene().live;
        EXPECT_TRUE(live && live->surface);
        const DepthSurface& surface = *live->surface;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                const double z = surface.depth_m.row(y)[x];
                if (z <= 0) continue;
                EXPECT_LT(z, 3);  // no wall
                const RayXy ray = surface.rays->row(y)[x];
                sum += glm::dvec3(z * ray.x, z * ray.y, z);
                ++count;
            }
        }
        EXPECT_GT(count, 100);
        return sum / count;
    };
    const glm::dvec3 seen = sum_of(plain), mirrored = sum_of(game);
    EXPECT_NEAR(mirrored.x, -seen.x, 0.02);
    EXPECT_NEAR(mirrored.y, seen.y, 0.02);
    // A picture is worked on once.
    const DepthSurface* before = game.play().scene().live->surface.get();
    game.go_on(0.2);
    EXPECT_EQ(game.play().scene().live->surface.get(), before);
    game.nobody(0.2);
    EXPECT_FALSE(game.play().scene().live.has_value());
}

TEST(Mirror, TwiceIsNothingAndSidesChange) {
    const BodyFrame frame{.time = 5, .bodies = {somebody(3, 0.4, 0.3)}};
    const BodyFrame once = demo::mirrored(frame), twice = demo::mirrored(once);
    for (std::size_t i = 0; i < kJointCount; ++i) {
        EXPECT_EQ(twice.bodies[0].joints[i].position_m, frame.bodies[0].joints[i].position_m);
    }
    EXPECT_EQ(once.bodies[0][Joint::hand_left].position_m.x,
              -frame.bodies[0][Joint::hand_right].position_m.x);
    EXPECT_EQ(once.bodies[0][Joint::foot_right].position_m.y,
              frame.bodies[0][Joint::foot_left].position_m.y);
    EXPECT_EQ(once.bodies[0][Joint::head].position_m.x, -frame.bodies[0][Joint::head].position_m.x);
    EXPECT_EQ(once.bodies[0].id, 3u);
}

}  // namespace
}  // namespace kino::test
