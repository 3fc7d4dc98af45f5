#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/skeleton/people/people_play.h"

namespace kino {
namespace {

using namespace test;

struct Walk {
    double from_x, to_x, z;
};

/// Both walk at once; ids of the two before and after.
void expect_identities_survive(const Walk& a, const Walk& b, double seconds) {
    Play play;
    play.learn();
    const int frames = static_cast<int>(seconds * 30);
    std::array<std::uint32_t, 2> before{};
    std::set<std::uint32_t> all;
    for (int i = 0; i < frames; ++i) {
        const double w = static_cast<double>(i) / (frames - 1), t = i / 30.0;
        play.next({actor_at(a.from_x + w * (a.to_x - a.from_x), a.z, Motion::walk, t),
                   actor_at(b.from_x + w * (b.to_x - b.from_x), b.z, Motion::walk, t + 3)});
        for (const Person& p : play.frame.people) all.insert(p.id);
        if (i == frames / 5) {
            before = {id_of(play.scene, 1, play.frame), id_of(play.scene, 2, play.frame)};
        }
    }
    ASSERT_NE(before[0], 0u);
    ASSERT_NE(before[1], 0u);
    ASSERT_NE(before[0], before[1]);
    EXPECT_EQ(id_of(play.scene, 1, play.frame), before[0]);
    EXPECT_EQ(id_of(play.scene, 2, play.frame), before[1]);
    EXPECT_EQ(all.size(), 2u);
}

TEST(PeopleIdentity, CrossingFarApartInDepth) {
    expect_identities_survive({-0.8, 0.8, -1.9}, {1.0, -1.0, -3.2}, 2.5);
}

TEST(PeopleIdentity, CrossingClosely) {
    expect_identities_survive({-0.9, 0.9, -2.2}, {0.9, -0.9, -2.9}, 2.5);
}

TEST(PeopleIdentity, CrossingSlowly) {
    expect_identities_survive({-0.7, 0.7, -2.0}, {0.9, -0.9, -3.0}, 6);
}

TEST(PeopleIdentity, HiddenForASecondIsTheSamePerson) {
    Play play;
    play.learn();
    const Actor still = actor_at(0.0, -3.0);
    std::uint32_t id = 0;
    int hidden = 0;
    for (int i = 0; i < 150; ++i) {
        // Somebody comes, stands close before the camera for a while, and goes.
        const double x = i < 50 ? -2.0 + 0.04 * i : (i < 90 ? 0.0 : 0.04 * (i - 90));
        play.next({still, actor_at(x, -1.3, Motion::idle, i / 30.0)});
        if (i == 15) id = id_of(play.scene, 1, play.frame);
        bool seen = false;
        for (const Person& p : play.frame.people) seen = seen || p.id == id;
        if (!seen) ++hidden;
    }
    ASSERT_NE(id, 0u);
    EXPECT_GT(hidden, 30);
    EXPECT_EQ(id_of(play.scene, 1, play.frame), id);
}

TEST(PeopleIdentity, TouchingPeopleAreHeldApart) {
    Play play;
    play.learn();
    std::array<std::uint32_t, 2> before{};
    bool merged = false;
    double worst = 1;
    for (int i = 0; i < 120; ++i) {
        // Towards each other until shoulders touch, a second there, and back.
        const double w = i < 45 ? i / 45.0 : (i < 75 ? 1.0 : (120 - i) / 45.0);
        play.next({actor_at(-0.8 + 0.57 * w, -2.4, Motion::idle, i / 30.0),
                   actor_at(0.8 - 0.57 * w, -2.4, Motion::idle, 4 + i / 30.0)});
        if (i == 10) before = {id_of(play.scene, 1, play.frame), id_of(play.scene, 2, play.frame)};
        if (i < 10) continue;
        ASSERT_EQ(play.frame.people.size(), 2u) << i;
        for (const Person& p : play.frame.people) merged = merged || p.merged;
        ASSERT_EQ(id_of(play.scene, 1, play.frame), before[0]) << i;
        ASSERT_EQ(id_of(play.scene, 2, play.frame), before[1]) << i;
        for (const Person& p : play.frame.people) {
            const std::uint8_t actor = p.id == before[0] ? 1 : 2;
            worst = std::min(worst, overlap(play.scene, actor, play.frame, p.slot));
        }
    }
    EXPECT_TRUE(merged);
    EXPECT_GT(worst, 0.8);
}

TEST(PeopleIdentity, SixPeopleHaveSixSlots) {
    RoomOptions room;
    room.furniture = false;
    room.back_wall_m = 6;
    Play play(room);
    play.learn();
    for (int i = 0; i < 20; ++i) {
        std::vector<Actor> actors;
        for (int k = 0; k < 7; ++k) {
            actors.push_back(actor_at(-1.5 + 0.5 * k, k % 2 ? -4.4 : -3.4, Motion::idle, k));
        }
        play.next(actors);
    }
    ASSERT_EQ(play.frame.people.size(), 6u);
    std::set<std::uint32_t> ids;
    for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_EQ(play.frame.people[k].slot, k + 1);
        ids.insert(play.frame.people[k].id);
    }
    EXPECT_EQ(ids.size(), 6u);
}

TEST(PeopleIdentity, IsForgottenAfterTheStatedTimeAndNeverGivenAgain) {
    Play play;
    play.learn();
    play.step = kNsPerSecond / 10;
    for (int i = 0; i < 10; ++i) play.next({actor_at(0, -2.5)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    const std::uint32_t id = play.frame.people[0].id;
    for (int i = 0; i < 29; ++i) play.next({});
    ASSERT_EQ(play.frame.lost.size(), 1u);
    EXPECT_EQ(play.frame.lost[0].id, id);
    for (int i = 0; i < 3; ++i) play.next({});
    EXPECT_TRUE(play.frame.lost.empty());
    for (int i = 0; i < 10; ++i) play.next({actor_at(0, -2.5)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    EXPECT_GT(play.frame.people[0].id, id);
}

}  // namespace
}  // namespace kino
