// The hard cases of finding people, by name: varied bodies in a known room, and their masks.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <set>

#include "skeleton/actors/actor_sequence.h"
#include "tests/skeleton/people/people_play.h"

namespace kino {
namespace {

using namespace test;

struct Outcome {
    int frames = 0;
    int more = 0;   ///< somebody who is not there
    int right = 0;  ///< everybody found, each by a person of his own, and nobody else
    double overlap = 0, worst = 1;
    double covered = 0;  ///< mean share of a person's pixels that somebody's mask holds
    std::set<std::uint32_t> ids;
    [[nodiscard]] double share() const { return static_cast<double>(right) / frames; }
};

struct Plan {
    const char* motion;
    int actors = 1;
    std::uint64_t seed = 4;
    int settle = 8;        ///< pictures with somebody in them that do not count
    int count = 30;        ///< that do
    double lead_in_s = 1;  ///< the empty room first
    bool furniture = false;
};

Outcome play(const Plan& plan) {
    ActorTake take;
    take.motion = plan.motion;
    take.actors = plan.actors;
    take.seed = plan.seed;
    take.lead_in_s = plan.lead_in_s;
    take.furniture = plan.furniture;
    auto sequence = ActorSequence::create(take);
    EXPECT_TRUE(sequence) << plan.motion;
    Outcome out;
    if (!sequence) return out;
    auto rig = Rig::create((*sequence)->rig());
    auto finder = PeopleFinder::create(rig->depth_rays());
    ActorFrame frame;
    PeopleFrame people;
    const int empty = static_cast<int>(plan.lead_in_s * (*sequence)->rate_hz());
    // The empty room is learned from every sixth picture; then every other one is looked at.
    for (int i = 0; i < (*sequence)->frames() && out.frames < plan.count; i += i < empty ? 6 : 2) {
        (*sequence)->render(i, frame);
        finder->find(frame.depth_m, frame.time, std::nullopt, people);
        if (i < empty) {
            EXPECT_TRUE(people.people.empty()) << plan.motion << " " << i;
        }
        if (i < empty + 2 * plan.settle) continue;
        std::array<double, 8> seen{}, labelled{};
        std::array<std::array<double, 8>, 8> both{};
        for (std::size_t p = 0; p < frame.actor.size(); ++p) {
            const std::size_t who = frame.depth_m.data()[p] > 0 ? frame.actor.data()[p] : 0;
            const std::size_t slot = people.labels.data()[p];
            seen[who] += 1;
            labelled[slot] += 1;
            both[slot][who] += 1;
        }
        std::size_t there = 0, found = 0;
        double least = 1, sum = 0, held = 0;
        for (std::size_t who = 1; who <= static_cast<std::size_t>(plan.actors); ++who) {
            if (seen[who] < 600) continue;  // a sleeve behind somebody else
            ++there;
            double best = 0, most = 0;
            for (const Person& p : people.people) {
                const double common = both[p.slot][who];
                most = std::max(most, common / seen[who]);
                best = std::max(best, common / (seen[who] + labelled[p.slot] - common));
            }
            found += best > 0.45;
            least = std::min(least, best);
            sum += best;
            held += most;
        }
        for (const Person& p : people.people) out.ids.insert(p.id);
        ++out.frames;
        out.more += people.people.size() > found;
        out.right += found == there && people.people.size() == there;
        out.overlap += there == 0 ? 1 : sum / static_cast<double>(there);
        out.covered += there == 0 ? 1 : held / static_cast<double>(there);
        out.worst = std::min(out.worst, least);
    }
    out.overlap /= std::max(out.frames, 1);
    out.covered /= std::max(out.frames, 1);
    ::testing::Test::RecordProperty(plan.motion, std::to_string(out.overlap));
    printf("%s: right %.2f, overlap %.3f, worst %.3f, covered %.3f, ids %zu\n", plan.motion,
           out.share(), out.overlap, out.worst, out.covered, out.ids.size());
    return out;
}

TEST(PeopleHardCases, EnteringAtTheBorder) {
    const Outcome o = play({.motion = "enter", .count = 40});
    EXPECT_GT(o.share(), 0.85);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.overlap, 0.85);
}

TEST(PeopleHardCases, Sideways) {
    const Outcome o = play({.motion = "sideways"});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.worst, 0.93);
}

TEST(PeopleHardCases, BackToTheCamera) {
    const Outcome o = play({.motion = "back"});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.worst, 0.93);
}

TEST(PeopleHardCases, Lying) {
    const Outcome o = play({.motion = "lie"});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.worst, 0.9);
}

TEST(PeopleHardCases, SittingOnAChair) {
    const Outcome o = play({.motion = "sit", .seed = 6});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.overlap, 0.85);
}

TEST(PeopleHardCases, HoldingALargeBoxItIsPartOfHim) {
    const Outcome o = play({.motion = "hold"});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.covered, 0.85);
    EXPECT_GT(o.overlap, 0.5);  // the box is as large as his trunk
}

TEST(PeopleHardCases, AHandOnTheWallDoesNotJoinTheWall) {
    const Outcome o = play({.motion = "wall"});
    EXPECT_EQ(o.right, o.frames);
    EXPECT_EQ(o.ids.size(), 1u);
    EXPECT_GT(o.worst, 0.93);
}

TEST(PeopleHardCases, HuggingTheyStayTwo) {
    const Outcome o = play({.motion = "hug", .actors = 2, .seed = 5, .count = 40});
    EXPECT_GT(o.share(), 0.85);
    EXPECT_EQ(o.ids.size(), 2u);
    EXPECT_GT(o.overlap, 0.8);
}

TEST(PeopleHardCases, WhoeverPassesAWardrobeDoesNotMakeItSomebody) {
    // Not yet learned, as free all around and as high as a person.
    const Outcome o =
        play({.motion = "hug", .actors = 2, .seed = 4, .count = 40, .furniture = true});
    EXPECT_LE(o.more, 2);
}

TEST(PeopleHardCases, CrossingTheyStayTwo) {
    const Outcome o = play({.motion = "cross", .actors = 2, .seed = 5, .count = 45});
    EXPECT_GT(o.share(), 0.85);
    EXPECT_EQ(o.ids.size(), 2u);
    EXPECT_GT(o.overlap, 0.8);
}

TEST(PeopleHardCases, ThereFromTheFirstPictureWithoutABackground) {
    int found = 0;
    for (const std::uint64_t seed : {1u, 6u, 8u, 10u, 12u}) {
        const Outcome o =
            play({.motion = "idle", .seed = seed, .count = 6, .lead_in_s = 0, .furniture = true});
        found += o.right == o.frames && o.overlap > 0.8;
    }
    EXPECT_EQ(found, 5);
}

TEST(PeopleHardCases, StandsLikeAStatueFromTheStart) {
    Play play;
    // The same pose in every picture, only the noise differs.
    for (int i = 0; i < 30; ++i) {
        play.next({actor_at(0.1, -2.4)});
        if (i < 12) continue;
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        ASSERT_GT(overlap(play.scene, 1, play.frame, 1), 0.9) << i;
    }
    EXPECT_LT(play.frame.people[0].confidence, 0.7f);  // a doll would look like that
}

TEST(PeopleHardCases, WhatNeverMovesIsFurnitureAfterTheStatedTime) {
    PeopleOptions options;
    options.tracker.still_s = 4;
    Play play({}, options);
    play.step = kNsPerSecond / 5;
    for (int i = 0; i < 15; ++i) play.next({actor_at(0.1, -2.4)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    for (int i = 0; i < 20; ++i) play.next({actor_at(0.1, -2.4)});
    EXPECT_TRUE(play.frame.people.empty());
    // And somebody again as soon as he moves out of himself.
    for (int i = 0; i < 10; ++i) play.next({actor_at(0.1 + 0.1 * i, -2.3, Motion::walk, 0.2 * i)});
    EXPECT_EQ(play.frame.people.size(), 1u);
}

TEST(PeopleHardCases, ArmsCrossedIsFound) {
    Play play;
    play.learn();
    for (int i = 0; i < 16; ++i) {
        Actor actor = actor_at(0, -2.4, Motion::idle, 0.05 * i);
        for (std::size_t side = 0; side < 2; ++side) {
            const double s = side == 0 ? 1 : -1;
            actor.pose.arm[side].upper = glm::normalize(glm::dvec3(s * 0.25, -1, 0.35));
            actor.pose.arm[side].lower = glm::normalize(glm::dvec3(-s, 0.12 + 0.05 * s, 0.35));
            actor.pose.arm[side].hand = glm::normalize(glm::dvec3(-s, 0.1, -0.1));
        }
        play.next({actor});
        if (i < 8) continue;
        ASSERT_EQ(play.frame.people.size(), 1u) << i;
        EXPECT_GT(overlap(play.scene, 1, play.frame, 1), 0.93) << i;
    }
}

TEST(PeopleHardCases, AShorterOneWhoComesWhereSomebodyWasLostIsSomebodyElse) {
    Play play;
    play.learn();
    for (int i = 0; i < 15; ++i) play.next({actor_at(0, -2.4)});
    ASSERT_EQ(play.frame.people.size(), 1u);
    const std::uint32_t id = play.frame.people[0].id;
    for (int i = 0; i < 45; ++i) play.next({});
    for (int i = 0; i < 15; ++i) {
        Actor child = actor_at(0.3, -2.4);
        child.world_from_body.translation.y -=
            0.45;  // knee-deep in the floor, which hides the rest
        play.next({child});
    }
    ASSERT_EQ(play.frame.people.size(), 1u);
    EXPECT_NE(play.frame.people[0].id, id);
}

}  // namespace
}  // namespace kino
