#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "skeleton/people/people_finder.h"
#include "tests/skeleton/people/people_scene.h"

namespace kino::test {

constexpr TimeNs kFrame = kNsPerSecond / 30;

inline PeopleFinder finder_for(const PeopleScene& scene, const PeopleOptions& options = {}) {
    auto finder = PeopleFinder::create(scene.rays(), options);
    EXPECT_TRUE(finder);
    return std::move(*finder);
}

inline PeopleOptions moving() {
    PeopleOptions options;
    options.moving_sensor = true;
    return options;
}

/// A finder and its scene through time.
struct Play {
    PeopleScene scene;
    PeopleFinder finder;
    PeopleFrame frame;
    TimeNs time = 0;
    TimeNs step = kFrame;
    std::uint64_t index = 0;

    explicit Play(const RoomOptions& room = {}, const PeopleOptions& options = {})
        : scene(room), finder(finder_for(scene, options)) {}

    void next(std::vector<Actor> actors) {
        scene.draw(actors, index++);
        time += step;
        finder.find(scene.depth_m(), time, std::nullopt, frame);
    }
    void learn(int frames = 30) {
        for (int i = 0; i < frames; ++i) next({});
    }
};

/// Intersection over union of one actor's pixels and one slot's.
inline double overlap(const PeopleScene& scene, std::uint8_t actor, const PeopleFrame& frame,
                      std::uint8_t slot) {
    double both = 0, either = 0;
    for (std::size_t i = 0; i < frame.labels.size(); ++i) {
        const bool a = scene.truth().data()[i] == actor, b = frame.labels.data()[i] == slot;
        both += a && b;
        either += a || b;
    }
    return either == 0 ? 1 : both / either;
}

/// The id of the person that covers most of the actor's pixels; 0 if nobody does.
inline std::uint32_t id_of(const PeopleScene& scene, std::uint8_t actor, const PeopleFrame& frame) {
    std::array<int, kPersonSlots + 1> votes{};
    for (std::size_t i = 0; i < frame.labels.size(); ++i) {
        if (scene.truth().data()[i] == actor) ++votes[frame.labels.data()[i]];
    }
    const auto most = std::max_element(votes.begin() + 1, votes.end());
    if (*most == 0) return 0;
    for (const Person& p : frame.people) {
        if (p.slot == most - votes.begin()) return p.id;
    }
    return 0;
}

}  // namespace kino::test
