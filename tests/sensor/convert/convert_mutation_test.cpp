#include <gtest/gtest.h>

#include <random>

#include "bag_bytes.h"
#include "fuzz/convert_targets.h"
#include "k4a_bytes.h"
#include "tests/support/mutation.h"

/// The fuzz targets on seeded mutations of sound files.
namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

/// How many mutations still played.
int mutate(const Buffer& seed, unsigned number, int rounds,
           int (*target)(std::span<const std::uint8_t>)) {
    EXPECT_GT(target(seed), 0);
    std::mt19937 random(number);
    int played = 0;
    for (int i = 0; i < rounds; ++i) {
        Buffer bytes = seed;
        for (unsigned n = 0; n < 1 + random() % 4; ++n) test::damage(bytes, random, 1500);
        played += target(bytes) > 0 ? 1 : 0;
    }
    return played;
}

TEST(ConvertMutations, AnyBytesAreSafeAsAnAzureKinectRecording) {
    // Depth in a track of our own, so that the frames stay small.
    test::K4aBytes file{.depth_width = 16, .depth_height = 12, .color_width = 8, .color_height = 6};
    file.depth_name = "KINOSCOPE_DEPTH";
    file.calibration = test::sample_k4a_calibration();
    for (const char* fourcc : {"MJPG", "NV12", "BGRA"}) {
        file.color_fourcc = fourcc;
        const int played = mutate(test::make_k4a(file), 1, 3000, &fuzz::k4a);
        EXPECT_GT(played, 500) << "mutations that only spoil everything test little";
    }
}

TEST(ConvertMutations, AnyBytesAreSafeAsABag) {
    for (const test::BagPacking packing :
         {test::BagPacking::none, test::BagPacking::lz4, test::BagPacking::bz2}) {
        for (const bool indexed : {true, false}) {
            const Buffer seed =
                test::make_bag({.frames = 2, .packing = packing, .indexed = indexed});
            const int played =
                mutate(seed, 2, packing == test::BagPacking::bz2 ? 300 : 2000, &fuzz::bag);
            EXPECT_GT(played, 50) << "mutations that only spoil everything test little";
        }
    }
}

}  // namespace
}  // namespace kino
