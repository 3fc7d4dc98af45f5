#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "sensor/playback.h"
#include "sensor/source.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

struct Expected {
    const char* folder;
    std::int64_t frames;
    int width, height;
    bool color;
    double near_m, far_m;  ///< the middle valid depth of frame 0 lies between
    LoopMode loop;
};

class Recordings : public ::testing::TestWithParam<Expected> {};

TEST_P(Recordings, OpensAndEveryFrameIsWhatItsCalibrationSays) {
    const Expected& want = GetParam();
    auto source = open_source(std::string("recordings/") + want.folder);
    ASSERT_TRUE(source) << source.error().to_string();
    EXPECT_FALSE((*source)->info().name.empty());
    EXPECT_FALSE((*source)->info().licence.empty());
    const auto rig = (*source)->calibration();
    ASSERT_TRUE(rig);
    EXPECT_TRUE(validate(*rig));
    EXPECT_EQ(rig->depth.width, want.width);
    EXPECT_EQ(rig->color.has_value(), want.color);
    ASSERT_TRUE(subscribe_all(**source));
    Timeline& timeline = *(*source)->timeline();
    ASSERT_EQ(timeline.frame_count(), want.frames);
    EXPECT_EQ(natural_loop(timeline), want.loop);
    const std::int64_t checked = std::min<std::int64_t>(want.frames, 12);
    for (std::int64_t i = 0; i < checked; ++i) {
        const auto set = (*source)->next(0);
        ASSERT_TRUE(set && *set) << set.error().to_string();
        const DepthFrame& depth = *(*set)->depth;
        ASSERT_EQ(depth.raw.width(), want.width);
        ASSERT_EQ(depth.raw.height(), want.height);
        EXPECT_EQ((*set)->color != nullptr, want.color);
        EXPECT_EQ((*set)->color_paired, want.color);
        std::vector<std::uint16_t> valid;
        for (const std::uint16_t raw : depth.raw.pixels()) {
            if (raw != 0) valid.push_back(raw);
        }
        ASSERT_GT(valid.size(), depth.raw.size() / 4);
        std::nth_element(valid.begin(), valid.begin() + valid.size() / 2, valid.end());
        const double middle = valid[valid.size() / 2] * depth.metres_per_unit;
        EXPECT_GT(middle, want.near_m);
        EXPECT_LT(middle, want.far_m);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Bundled, Recordings,
    ::testing::Values(Expected{"person", 285, 512, 512, false, 0.8, 1.2, LoopMode::loop},
                      Expected{"desk", 6, 640, 480, true, 1.0, 1.3, LoopMode::ping_pong},
                      Expected{"office", 1, 640, 480, true, 4.0, 4.7, LoopMode::loop},
                      Expected{"laptop", 2, 640, 480, true, 0.8, 1.0, LoopMode::ping_pong},
                      Expected{"tabletop", 1, 640, 480, true, 0.6, 0.9, LoopMode::loop},
                      Expected{"bust", 1, 640, 480, false, 2.4, 2.9, LoopMode::loop},
                      Expected{"gestures", 9, 640, 480, false, 2.9, 3.5, LoopMode::loop}),
    [](const auto& test) { return std::string(test.param.folder); });

TEST(RecordingOfTheDesk, CarriesPosesOfACameraThatLooksDownAtIt) {
    auto source = open_source("recordings/desk");
    ASSERT_TRUE(source) << source.error().to_string();
    for (int i = 0; i < 6; ++i) {
        const auto set = (*source)->next(0);
        ASSERT_TRUE(set && *set);
        ASSERT_EQ((*set)->pose_origin, PoseOrigin::trajectory);
        const Pose& pose = (*set)->world_from_depth;
        EXPECT_NEAR(pose.translation.y, 1.52, 0.03) << "held about 1.5 m above the floor";
        EXPECT_LT((pose.rotation * glm::dvec3(0, 0, 1)).y, -0.3) << "it looks downwards";
        EXPECT_GT((pose.rotation * glm::dvec3(0, -1, 0)).y, 0.3) << "and is not upside down";
    }
}

TEST(RecordingOfThePerson, SaysThatItsDistancesAreRough) {
    auto source = open_source("recordings/person");
    ASSERT_TRUE(source);
    EXPECT_THAT((*source)->info().note, ::testing::HasSubstr("roughly metric"));
    EXPECT_TRUE((*source)->info().seated_people);
    EXPECT_FALSE((*source)->subscribe({0, StreamKind::color}));
}

TEST(RecordingOfThePerson, SeekingGivesTheDepthThatPlayingGives) {
    auto playing = *open_source("recordings/person");
    auto seeking = *open_source("recordings/person");
    ASSERT_TRUE(subscribe_all(*playing));
    ASSERT_TRUE(subscribe_all(*seeking));
    std::vector<std::shared_ptr<const DepthFrame>> played;
    for (int i = 0; i < 30; ++i) played.push_back((**playing->next(0)).depth);
    for (const std::int64_t i : {29, 3, 17, 16, 28, 0}) {
        ASSERT_TRUE(seeking->timeline()->seek(i));
        const auto set = seeking->next(0);
        ASSERT_TRUE(set && *set);
        EXPECT_EQ((*set)->depth->raw, played[static_cast<std::size_t>(i)]->raw) << i;
    }
}

TEST(RecordingsFolder, StaysUnder25MB) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator("recordings")) {
        if (entry.is_regular_file()) bytes += entry.file_size();
    }
    EXPECT_LT(bytes, 25'000'000u);
    EXPECT_GT(bytes, 1'000'000u);
}

}  // namespace
}  // namespace kino
