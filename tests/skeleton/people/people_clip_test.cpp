#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/rig.h"
#include "sensor/openers.h"
#include "sensor/source.h"
#include "skeleton/people/people_finder.h"

namespace kino {
namespace {

/// Plays a recording; `see` gets each depth picture in metres and its time.
template <class See>
void play(const std::string& uri, See see) {
    auto source = open_source(uri);
    ASSERT_TRUE(source) << source.error().to_string();
    ASSERT_TRUE(subscribe_all(**source));
    auto rig = Rig::create(*(*source)->calibration());
    ASSERT_TRUE(rig);
    RegisteredDepth depth;
    while (true) {
        auto set = (*source)->next(0);
        ASSERT_TRUE(set);
        if (!*set) break;
        if (!(*set)->depth) continue;
        ASSERT_TRUE(rig->register_depth(*(*set)->depth, depth));
        see(*rig, depth.depth_m, (*set)->time);
    }
}

/// How many are found in a picture of its own: no motion, no background.
std::vector<std::size_t> people_in_stills(const std::string& uri) {
    std::vector<std::size_t> counts;
    play(uri, [&](const Rig& rig, const Image<float>& depth, TimeNs) {
        PeopleOptions options;
        options.moving_sensor = true;
        auto finder = PeopleFinder::create(rig.depth_rays(), options);
        ASSERT_TRUE(finder);
        PeopleFrame people;
        for (int i = 1; i <= 2; ++i)
            finder->find(depth, i * kNsPerSecond / 5, std::nullopt, people);
        counts.push_back(people.people.size());
    });
    return counts;
}

// A man at a desk, 20 s of a film of a depth picture: no truth, but he is there all the time,
// alone.
TEST(PeopleClip, TheManAtTheDeskIsOnePersonAllTheTime) {
    std::optional<PeopleFinder> finder;
    PeopleFrame people;
    std::array<int, 8> histogram{};
    std::array<int, 16> of_id{};
    int frames = 0, at_his_place = 0;
    play("recordings/person", [&](const Rig& rig, const Image<float>& depth, TimeNs time) {
        if (!finder) {
            auto made = PeopleFinder::create(rig.depth_rays());
            ASSERT_TRUE(made);
            finder.emplace(std::move(*made));
        }
        finder->find(depth, time, std::nullopt, people);
        ++frames;
        ++histogram[people.people.size()];
        for (const Person& p : people.people) {
            ++of_id[std::min<std::size_t>(p.id, of_id.size() - 1)];
            // Head to waist and arms, at the desk; never only a sheet of paper.
            if (p.centroid_m.z > 0.6f && p.centroid_m.z < 1.2f && p.area_m2 > 0.2f &&
                p.box_max_m.y - p.box_min_m.y > 0.5f) {
                ++at_his_place;
            }
        }
    });
    EXPECT_GT(frames, 250);
    EXPECT_GE(histogram[1], frames * 95 / 100);
    EXPECT_EQ(of_id[1], histogram[1]);  // always the same one
    EXPECT_GE(at_his_place, frames * 90 / 100);
}

TEST(PeopleClip, TheManBehindTheCouchIsFoundInEverySinglePicture) {
    EXPECT_EQ(people_in_stills("recordings/gestures"), std::vector<std::size_t>(9, 1));
}

TEST(PeopleClip, HeadAndShouldersInProfileAreSomebody) {
    EXPECT_EQ(people_in_stills("recordings/bust"), std::vector<std::size_t>{1});
}

TEST(PeopleClip, RealRoomsAndTablesHoldNobody) {
    for (const char* uri :
         {"recordings/office", "recordings/desk", "recordings/laptop", "recordings/tabletop"}) {
        for (const std::size_t n : people_in_stills(uri)) EXPECT_EQ(n, 0u) << uri;
    }
}

}  // namespace
}  // namespace kino
