// Who is told of at once, who later, and what is left alone.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <set>

#include "tests/skeleton/people/people_play.h"

namespace kino {
namespace {

using namespace test;

TEST(PeopleFirstSight, AHeadOnABodyBeforeAKnownRoomIsSomebodyAtOnce) {
    for (const double z : {-2.0, -2.5, -3.2}) {
        Play play;
        play.learn();
        EXPECT_TRUE(play.frame.people.empty());
        play.next({actor_at(0.1, z)});
        ASSERT_EQ(play.frame.people.size(), 1u) << z;
        EXPECT_GT(overlap(play.scene, 1, play.frame, play.frame.people[0].slot), 0.9) << z;
        const std::uint32_t id = play.frame.people[0].id;
        play.next({actor_at(0.1, z)});
        ASSERT_EQ(play.frame.people.size(), 1u) << z;
        EXPECT_EQ(play.frame.people[0].id, id) << z;
    }
}

TEST(PeopleFirstSight, WhereNoRoomIsKnownOnePictureIsNotEnough) {
    Play play;
    play.next({actor_at(0.1, -1.4)});
    EXPECT_TRUE(play.frame.people.empty());
}

TEST(PeopleFirstSight, APictureOfAPersonWithoutHeadIsNotEnough) {
    // Only the legs show below a screen.
    Play play;
    play.learn();
    const std::vector<Actor> actors{actor_at(0.1, -1.4)};
    play.scene.draw(actors, play.index++);
    Image<float> depth = play.scene.depth_m();
    for (int y = 0; y < depth.height() / 2; ++y)
        std::fill(depth.row(y), depth.row(y) + depth.width(), 0.0f);
    play.finder.find(depth, play.time += kFrame, std::nullopt, play.frame);
    EXPECT_TRUE(play.frame.people.empty());
}

struct Box {
    glm::vec3 low, high;  // upright axes: x to the right, y above the floor, z towards the camera
};

// Boxes drawn before what is there, along the rays of the scene's camera.
void put(const PeopleScene& scene, const std::vector<Box>& boxes, Image<float>& depth) {
    const glm::mat3 upright = upright_from_camera(scene.up());
    const glm::vec3 from(0, scene.camera_height_m(), 0);
    for (int y = 0; y < depth.height(); ++y) {
        for (int x = 0; x < depth.width(); ++x) {
            const RayXy& ray = scene.rays().at(x, y);
            const glm::vec3 way = upright * glm::vec3(ray.x, ray.y, 1);
            for (const Box& box : boxes) {
                float enter = 0, leave = std::numeric_limits<float>::max();
                for (int k = 0; k < 3; ++k) {
                    const float a = (box.low[k] - from[k]) / way[k];
                    const float b = (box.high[k] - from[k]) / way[k];
                    enter = std::max(enter, std::min(a, b));
                    leave = std::min(leave, std::max(a, b));
                }
                float& z = depth.at(x, y);
                if (enter < leave && (z == 0 || enter < z)) z = enter;
            }
        }
    }
}

std::vector<Box> high_chair(float x, float z) {
    const auto box = [&](float x0, float x1, float y0, float y1, float z0, float z1) {
        return Box{{x + x0, y0, z + z0}, {x + x1, y1, z + z1}};
    };
    return {box(-0.22f, 0.22f, 0.44f, 1.36f, -0.25f, -0.20f),
            box(-0.22f, 0.22f, 0.42f, 0.48f, -0.20f, 0.22f),
            box(-0.22f, -0.18f, 0, 0.44f, 0.18f, 0.22f),
            box(0.18f, 0.22f, 0, 0.44f, 0.18f, 0.22f),
            box(-0.22f, -0.18f, 0, 0.44f, -0.25f, -0.20f),
            box(0.18f, 0.22f, 0, 0.44f, -0.25f, -0.20f)};
}

TEST(PeopleFirstSight, AHighChairThatIsLeftElsewhereIsNobody) {
    Play play;
    const auto see = [&](float x, float z) {
        play.scene.draw({}, play.index++);
        Image<float> depth = play.scene.depth_m();
        put(play.scene, high_chair(x, z), depth);
        play.finder.find(depth, play.time += kFrame, std::nullopt, play.frame);
    };
    for (int i = 0; i < 30; ++i) {
        see(-0.5f, -2.6f);
        EXPECT_TRUE(play.frame.people.empty()) << i;
    }
    for (int i = 0; i < 90; ++i) {
        see(0.4f, -2.2f);
        ASSERT_TRUE(play.frame.people.empty()) << i;
    }
}

TEST(PeopleFirstSight, TwoWhoComeInTouchingAreTwoOnceBothHeadsHaveShown) {
    Play play;
    play.learn();
    std::set<std::uint32_t> ids;
    int two = 0;
    for (int i = 0; i < 75; ++i) {
        const double t = i / 30.0, x = -1.9 + 0.8 * t;
        play.next({actor_at(x, -2.3, Motion::idle, t), actor_at(x + 0.42, -2.3, Motion::idle, t)});
        EXPECT_LE(play.frame.people.size(), 2u) << i;
        for (const Person& p : play.frame.people) ids.insert(p.id);
        if (i >= 55) two += play.frame.people.size() == 2 ? 1 : 0;
    }
    EXPECT_EQ(two, 20);
    EXPECT_LE(ids.size(), 3u);
}

Blob bust(float free) {
    Blob blob;
    for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < 8; ++x) {
            CellPoint c;
            c.cell = y * 8 + x;
            c.upright_m = {0.05f * static_cast<float>(x) - 0.175f,
                           1.7f - 0.05f * static_cast<float>(y), -2};
            c.area_m2 = 0.0025f;
            blob.cells.push_back(c);
        }
    }
    blob.measure();
    blob.free = free;
    blob.heads.push_back({{0, 1.65f, -2}, 0.95f});
    return blob;
}

TEST(PersonTest, AHeadIsClearFromTheStatedShareOfAFreeOutlineOn) {
    PersonTest test;
    test.floor_known = true;
    for (const float stated : {test.min_head_free, 0.5f}) {
        test.min_head_free = stated;
        const Blob below = bust(stated - 0.01f), above = bust(stated + 0.01f);
        EXPECT_FALSE(test.clear_head(below, below.heads[0])) << stated;
        EXPECT_TRUE(test.clear_head(above, above.heads[0])) << stated;
    }
}

}  // namespace
}  // namespace kino
