// What holds of the tracker as a whole: memory, moving along, and what is hidden.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <glm/geometric.hpp>
#include <memory>

#include "skeleton/forest/default_forest.h"
#include "tests/skeleton/tracking/tracked_scene.h"

namespace kino {
namespace {

using namespace test;

std::size_t bytes_in_use() {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

// A sanitizer's allocator does not keep the C library's books.
bool books_are_kept() {
    const std::size_t before = bytes_in_use();
    char* volatile block = static_cast<char*>(std::malloc(4'000'000));
    const std::size_t with = bytes_in_use();
    std::free(block);
    return with >= before + 4'000'000;
}

TEST(TrackerMemory, ForestAndTrackerOwnLessThanAHundredMegabytes) {
    ASSERT_TRUE(books_are_kept()) << "another allocator; sanitized builds leave this test out";
    RoomOptions room;
    room.width = 640;
    room.height = 480;
    PeopleScene scene(room);
    const Image<RayXy> rays = scene.rays();
    const auto shipped = default_forest();
    ASSERT_TRUE(shipped);

    const std::size_t before = bytes_in_use();
    auto forest = std::make_shared<const Forest>(**shipped);  // its bytes, whoever read it first
    auto tracker = BodyTracker::create(rays, forest);
    ASSERT_TRUE(tracker);
    const std::size_t created = bytes_in_use() - before;
    BodyFrame frame;
    for (std::uint64_t i = 0; i < 24; ++i) {
        scene.draw(
            i < 16 ? std::vector<Actor>{} : std::vector{actor_at(-0.5, -2.4), actor_at(0.6, -2.6)},
            i);
        tracker->track(scene.depth_m(), static_cast<TimeNs>(i + 1) * kNsPerSecond / 15,
                       std::nullopt, frame);
    }
    ASSERT_EQ(frame.bodies.size(), 2u);
    const std::size_t all = bytes_in_use() - before;  // less what the scene grew by, if it did
    printf("created %.1f MB, with two people %.1f MB\n", 1e-6 * static_cast<double>(created),
           1e-6 * static_cast<double>(all));
    EXPECT_GT(all, 5'000'000u);
    EXPECT_LT(all, 100'000'000u);
    const std::size_t settled = all;
    for (std::uint64_t i = 24; i < 40; ++i) {
        scene.draw(std::vector{actor_at(-0.5, -2.4), actor_at(0.6, -2.6)}, i);
        tracker->track(scene.depth_m(), static_cast<TimeNs>(i + 1) * kNsPerSecond / 15,
                       std::nullopt, frame);
    }
    EXPECT_LT(bytes_in_use() - before, settled + 1'000'000) << "it grows with time";
}

TEST(TrackerLaws, WhoeverMovesWithTheSensorMovesNoJointBeforeIt) {
    // An endless wall, so that the pictures of both places differ in nothing that is not the room.
    std::vector<Body> found;
    for (const double along : {0.0, 0.35}) {
        RoomOptions room;
        room.furniture = false;
        room.noise = false;
        room.camera_x_m = along;
        TrackedScene s(room);
        s.learn_room();
        for (int i = 0; i < 12; ++i)
            s.next({actor_at(0.1 + along, -2.4, Motion::wave, 1 + i / 30.0)});
        ASSERT_EQ(s.frame.bodies.size(), 1u);
        found.push_back(s.frame.bodies[0]);
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_EQ(found[0].joints[j].state, found[1].joints[j].state) << j;
        EXPECT_LT(glm::distance(found[0].joints[j].position_m, found[1].joints[j].position_m),
                  0.004f)
            << joint_name(static_cast<Joint>(j));
    }
}

TEST(TrackerLaws, AWholePersonHasJointsInTheFirstPicture) {
    TrackedScene s;
    s.learn_room();
    const Actor actor = actor_at(0, -2.4, Motion::idle);
    s.next({actor});
    ASSERT_EQ(s.frame.bodies.size(), 1u);
    EXPECT_LT(mean_of(errors_mm(s.truth(actor), &s.frame.bodies[0])), 70);
}

TEST(TrackerLaws, ACupboardBeforeOneLegLeavesTheOtherWhereItIs) {
    // Whatever is left of the pelvis's middle is behind something nearer.
    TrackedScene s;
    s.learn_room();
    const Actor actor = actor_at(0, -2.6, Motion::idle);
    const Body truth = s.truth(actor);
    const glm::vec3 hips = truth[Joint::hip_center].position_m;
    Image<float> depth;
    BodyFrame frame;
    const auto see = [&](const std::vector<Actor>& actors) {
        s.scene.draw(actors, s.index++);
        depth = s.scene.depth_m();
        for (int y = 0; y < depth.height(); ++y)
            for (int x = 0; x < depth.width(); ++x)
                if (s.scene.rays().at(x, y).x * hips.z > hips.x + 0.03f) depth.at(x, y) = 1.8f;
        s.tracker.track(depth, s.time += s.step, std::nullopt, frame);
    };
    for (int i = 0; i < 30; ++i) see({});
    for (int i = 0; i < 30; ++i) see({actor});
    const Body* body = nearest_body(frame, truth);
    ASSERT_NE(body, nullptr);
    const bool left_hidden = truth[Joint::hip_left].position_m.x > hips.x;
    const std::size_t seen = left_hidden ? 16 : 12;
    EXPECT_LT(mean_of(errors_mm(truth, body, 0, 3)), 80);
    EXPECT_LT(mean_of(errors_mm(truth, body, seen, seen + 3)), 80);
}

}  // namespace
}  // namespace kino
