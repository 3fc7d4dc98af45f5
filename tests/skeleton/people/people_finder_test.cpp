#include "skeleton/people/people_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "tests/skeleton/people/people_play.h"

namespace kino {
namespace {

using namespace test;

TEST(PeopleFinder, EmptyRoomForAMinuteHasNoPhantom) {
    Play play;
    play.step = kNsPerSecond / 8;
    for (int i = 0; i < 480; ++i) {
        play.next({});
        ASSERT_TRUE(play.frame.people.empty()) << "frame " << i;
        ASSERT_TRUE(play.frame.lost.empty()) << "frame " << i;
    }
    EXPECT_GT(play.frame.background_known, 0.85f);
    EXPECT_EQ(std::count(play.frame.labels.pixels().begin(), play.frame.labels.pixels().end(), 0),
              static_cast<std::ptrdiff_t>(play.frame.labels.size()));
}

TEST(PeopleFinder, EmptyRoomHasNoPhantomForAMovingSensor) {
    for (int i = 0; i < 12; ++i) {
        RoomOptions room;
        room.camera_x_m = -0.6 + 0.1 * i;
        room.tilt_deg = -10 + i;
        Play play(room, moving());
        play.learn(6);
        EXPECT_TRUE(play.frame.people.empty()) << "place " << i;
    }
}

TEST(PeopleFinder, MaskIsTheTrueMask) {
    for (const Motion motion : {Motion::idle, Motion::tpose, Motion::raise, Motion::squat}) {
        Play play;
        play.learn();
        double sum = 0;
        const int frames = 15;
        for (int i = 0; i < frames + 10; ++i) {
            const double t = 2.0 + 0.2 * i;
            play.next({actor_at(0, -2.5, motion, t)});
            if (i < 10) continue;
            ASSERT_EQ(play.frame.people.size(), 1u) << motion_name(motion) << " " << i;
            sum += overlap(play.scene, 1, play.frame, play.frame.people[0].slot);
        }
        EXPECT_GT(sum / frames, 0.93) << motion_name(motion);
        RecordProperty(std::string(motion_name(motion)), std::to_string(sum / frames));
    }
}

TEST(PeopleFinder, NearAndFarAreFoundAndMasked) {
    struct Case {
        double z_m, least;
    };
    for (const Case c : {Case{0.8, 0.9}, Case{1.2, 0.9}, Case{3.5, 0.9}, Case{4.5, 0.85}}) {
        RoomOptions room;
        room.furniture = false;
        room.back_wall_m = 6.5;
        Play play(room);
        play.learn();
        double worst = 1;
        for (int i = 0; i < 20; ++i) {
            play.next({actor_at(0, -c.z_m, Motion::wave, 2 + 0.05 * i)});
            if (i < 8) continue;
            ASSERT_EQ(play.frame.people.size(), 1u) << c.z_m << " m, frame " << i;
            worst = std::min(worst, overlap(play.scene, 1, play.frame, 1));
        }
        EXPECT_GT(worst, c.least) << c.z_m;
    }
}

// The visible front is at 0.6 m; only trunk and arms are in view.
TEST(PeopleFinder, AtSixtyCentimetresTheTrunkIsFound) {
    Play play;
    play.learn();
    for (int i = 0; i < 20; ++i) {
        play.next({actor_at(0, -0.72, Motion::idle, 0.05 * i)});
        if (i < 8) continue;
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        EXPECT_TRUE(play.frame.people[0].touches_border);
        EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.93);
    }
}

TEST(PeopleFinder, EntersAtTheBorderWithOneIdentity) {
    Play play;
    play.learn();
    std::set<std::uint32_t> ids;
    bool touched = false, free = false;
    for (int i = 0; i < 90; ++i) {
        const double x = -2.0 + 2.0 * i / 89;
        play.next({actor_at(x, -2.4, Motion::walk, i / 30.0)});
        for (const Person& p : play.frame.people) {
            ids.insert(p.id);
            (p.touches_border ? touched : free) = true;
        }
        ASSERT_LE(play.frame.people.size(), 1u) << i;
    }
    EXPECT_EQ(ids.size(), 1u);
    EXPECT_TRUE(touched);
    EXPECT_TRUE(free);
    ASSERT_EQ(play.frame.people.size(), 1u);
    EXPECT_FALSE(play.frame.people[0].touches_border);
    EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.9);
}

TEST(PeopleFinder, HalfOutOfViewIsFoundAndSaidToTouchTheBorder) {
    Play play;
    play.learn();
    for (int i = 0; i < 20; ++i) {
        play.next({actor_at(-1.05, -2.0, Motion::idle, 0.05 * i)});
        if (i < 8) continue;
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        EXPECT_TRUE(play.frame.people[0].touches_border);
        EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.85);
    }
}

TEST(PeopleFinder, StandingStillForAMinuteDoesNotMeltAway) {
    Play play;
    play.learn();
    play.step = kNsPerSecond / 10;
    for (int i = 0; i < 15; ++i)
        play.next({actor_at(-1.2 + 0.08 * i, -2.5, Motion::walk, 0.1 * i)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    const std::uint32_t id = play.frame.people[0].id;
    play.step = kNsPerSecond / 2;
    // Not the least movement: the same pose in every picture, only noise differs.
    for (int i = 0; i < 120; ++i) {
        play.next({actor_at(0, -2.5)});
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        ASSERT_EQ(play.frame.people[0].id, id) << i;
    }
    EXPECT_GT(overlap(play.scene, 1, play.frame, play.frame.people[0].slot), 0.93);
    // And he leaves no ghost behind.
    for (int i = 0; i < 40; ++i) play.next({});
    EXPECT_TRUE(play.frame.people.empty());
    EXPECT_TRUE(play.frame.lost.empty());
}

TEST(PeopleFinder, ThereFromTheStartIsFoundWithoutABackground) {
    Play play;
    for (int i = 0; i < 90; ++i) {
        play.next({actor_at(0, -2.4, Motion::wave, 2 + i / 30.0)});
        if (i < 45) continue;  // he must be seen to move first
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
    }
    EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.9);
}

TEST(PeopleFinder, LyingOnTheFloorIsSomebody) {
    Play play;
    play.learn();
    for (int i = 0; i < 20; ++i) {
        play.next({lying_at(0, -2.6)});
        if (i < 8) continue;
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.85);
        const Person& p = play.frame.people[0];
        EXPECT_LT(p.box_max_m.y, 0.6f);
        EXPECT_GT(p.box_max_m.x - p.box_min_m.x, 1.4f);
    }
}

TEST(PeopleFinder, SensorTiltedThirtyDegreesFindsFloorAndPerson) {
    for (const double tilt : {-30.0, 30.0, -15.0}) {
        RoomOptions room;
        room.tilt_deg = tilt;
        room.camera_height_m = tilt < 0 ? 2.1 : 0.5;
        Play play(room);
        play.learn();
        for (int i = 0; i < 20; ++i) {
            play.next({actor_at(0, -2.2, Motion::idle, 0.05 * i)});
            if (i < 8) continue;
            ASSERT_EQ(play.frame.people.size(), 1u) << tilt << " " << i;
            EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.85) << tilt;
        }
        if (tilt > 0) continue;  // no floor in the picture
        EXPECT_GT(play.frame.floor.confidence, 0.5f) << tilt;
        EXPECT_GT(glm::dot(play.frame.floor.up, play.scene.up()), std::cos(0.5 * M_PI / 180));
        EXPECT_NEAR(play.frame.floor.height_m, 2.1, 0.02);
        EXPECT_NEAR(play.frame.people[0].box_max_m.y, 1.75, 0.08) << tilt;
    }
}

TEST(PeopleFinder, MovingSensorKeepsThePerson) {
    PeopleScene first;
    PeopleFinder finder = finder_for(first, moving());
    PeopleFrame frame;
    std::set<std::uint32_t> ids;
    double sum = 0;
    int seen = 0;
    for (int i = 0; i < 60; ++i) {
        RoomOptions room;
        room.camera_x_m = 0.3 * std::sin(0.1 * i);
        room.tilt_deg = -5 + 4 * std::cos(0.15 * i);
        room.roll_deg = 3 * std::sin(0.2 * i);
        PeopleScene scene(room);
        scene.draw(std::vector{actor_at(0.1, -2.4, Motion::wave, i / 30.0)}, i);
        finder.find(scene.depth_m(), (i + 1) * kFrame, std::nullopt, frame);
        for (const Person& p : frame.people) ids.insert(p.id);
        if (i < 6) continue;
        seen += frame.people.size() == 1;
        sum += frame.people.empty() ? 0 : overlap(scene, 1, frame, frame.people[0].slot);
    }
    EXPECT_EQ(seen, 54);
    EXPECT_EQ(ids.size(), 1u);
    EXPECT_GT(sum / 54, 0.85);
}

TEST(PeopleFinder, NoReadingsAtAllIsNobody) {
    Play play;
    play.learn();
    for (int i = 0; i < 15; ++i) play.next({actor_at(0, -2.5)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    const auto nan = std::numeric_limits<float>::quiet_NaN();
    const auto inf = std::numeric_limits<float>::infinity();
    for (const float nothing : {nan, 0.0f, -1.0f, inf, -inf, 1e30f, 1e-30f}) {
        const Image<float> depth(320, 240, nothing);
        play.time += kFrame;
        play.finder.find(depth, play.time, std::nullopt, play.frame);
        EXPECT_TRUE(play.frame.people.empty());
        EXPECT_EQ(play.frame.lost.size(), 1u);
        EXPECT_FALSE(play.frame.floor.known());
    }
    // The person is the same one after the gap.
    play.next({actor_at(0, -2.5)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    EXPECT_EQ(play.frame.people[0].id, 1u);
}

TEST(PeopleFinder, NanAmongReadingsIsLeftOut) {
    Play play;
    play.learn();
    for (int i = 0; i < 20; ++i) {
        play.scene.draw(std::vector{actor_at(0, -2.5)}, 100 + i);
        Image<float> depth = play.scene.depth_m();
        for (std::size_t k = i % 3; k < depth.size(); k += 3) {
            depth.data()[k] = std::numeric_limits<float>::quiet_NaN();
        }
        play.time += kFrame;
        play.finder.find(depth, play.time, glm::vec3(NAN), play.frame);
        for (std::size_t k = i % 3; k < depth.size(); k += 3)
            ASSERT_EQ(play.frame.labels.data()[k], 0);
    }
    ASSERT_EQ(play.frame.people.size(), 1u);
    const Person& p = play.frame.people[0];
    EXPECT_TRUE(std::isfinite(p.centroid_m.x + p.box_min_m.x + p.box_max_m.y + p.confidence));
    EXPECT_NEAR(p.centroid_m.z, 2.5, 0.15);
}

TEST(PeopleFinder, SlowAndFastSourcesFindTheSame) {
    for (const int hz : {1, 5, 60}) {
        Play play;
        play.step = kNsPerSecond / hz;
        play.learn(std::max(5, hz));
        const int frames = std::max(8, hz);
        std::set<std::uint32_t> ids;
        int found = 0;
        for (int i = 0; i < frames; ++i) {
            const double t = static_cast<double>(i) / hz;
            play.next({actor_at(-0.4 + 0.1 * t, -2.5, Motion::walk, t)});
            for (const Person& p : play.frame.people) ids.insert(p.id);
            found += play.frame.people.size() == 1;
        }
        EXPECT_EQ(ids.size(), 1u) << hz;
        EXPECT_GE(found, frames - std::max(1, hz / 6)) << hz;
    }
}

TEST(PeopleFinder, TheSamePicturesGiveTheSameBits) {
    Play a, b;
    for (int i = 0; i < 45; ++i) {
        std::vector<Actor> actors;
        if (i >= 20) {
            actors = {actor_at(0, -2.5, Motion::dance, i / 30.0),
                      actor_at(0.9, -3.0, Motion::wave, i / 30.0)};
        }
        a.next(actors);
        b.next(actors);
        ASSERT_EQ(a.frame.labels, b.frame.labels);
        ASSERT_EQ(a.frame.people.size(), b.frame.people.size());
        for (std::size_t p = 0; p < a.frame.people.size(); ++p) {
            EXPECT_EQ(a.frame.people[p].centroid_m, b.frame.people[p].centroid_m);
            EXPECT_EQ(a.frame.people[p].id, b.frame.people[p].id);
            EXPECT_EQ(a.frame.people[p].box, b.frame.people[p].box);
        }
    }
    EXPECT_EQ(a.frame.people.size(), 2u);
}

TEST(PeopleFinder, CountsAndBoxesAreThoseOfTheLabels) {
    Play play;
    play.learn();
    for (int i = 0; i < 15; ++i) {
        play.next({actor_at(-0.6, -2.3, Motion::dance, 1 + i / 30.0),
                   actor_at(0.7, -3.0, Motion::raise, 3 + i / 30.0)});
    }
    ASSERT_EQ(play.frame.people.size(), 2u);
    for (const Person& p : play.frame.people) {
        int count = 0;
        PixelBox box{320, 240, 0, 0};
        for (int y = 0; y < 240; ++y) {
            for (int x = 0; x < 320; ++x) {
                if (play.frame.labels.at(x, y) != p.slot) continue;
                ++count;
                box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                       std::max(box.y1, y + 1)};
            }
        }
        EXPECT_EQ(count, p.pixels);
        EXPECT_EQ(box, p.box);
        EXPECT_GT(p.confidence, 0.5f);
    }
}

TEST(PeopleFinder, RefusesWhatIsNoCamera) {
    EXPECT_FALSE(PeopleFinder::create(Image<RayXy>(8, 8)));
    const auto nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(PeopleFinder::create(Image<RayXy>(64, 64, RayXy{nan, nan})));
    PeopleOptions options;
    options.cell_px = 50;
    EXPECT_FALSE(PeopleFinder::create(Image<RayXy>(64, 64), options));
}

}  // namespace
}  // namespace kino
