#include <gtest/gtest.h>

#include "calibration/rig.h"
#include "sensor/openers.h"
#include "sensor/source.h"
#include "skeleton/people/people_finder.h"

namespace kino {
namespace {

// A sanity check, no truth: a man at a desk, 20 s of a film of a depth picture. He is there from
// the first frame to the last.
TEST(PeopleClip, SomebodyIsFoundInMostFrames) {
    auto source = open_source("recordings/person");
    ASSERT_TRUE(source) << source.error().to_string();
    ASSERT_TRUE(subscribe_all(**source));
    auto rig = Rig::create(*(*source)->calibration());
    ASSERT_TRUE(rig);
    auto finder = PeopleFinder::create(rig->depth_rays());
    ASSERT_TRUE(finder);
    RegisteredDepth depth;
    PeopleFrame people;
    std::array<int, 8> histogram{};
    int frames = 0;
    while (true) {
        auto set = (*source)->next(0);
        ASSERT_TRUE(set);
        if (!*set) break;
        if (!(*set)->depth) continue;
        ASSERT_TRUE(rig->register_depth(*(*set)->depth, depth));
        finder->find(depth.depth_m, (*set)->time, std::nullopt, people);
        ++frames;
        ++histogram[people.people.size()];
    }
    EXPECT_GT(frames, 250);
    EXPECT_LT(histogram[0], frames * 2 / 10);
}

}  // namespace
}  // namespace kino
