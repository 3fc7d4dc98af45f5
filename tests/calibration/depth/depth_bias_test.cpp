#include "calibration/depth_bias.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "apps/pipeline/processor.h"
#include "fuzz/targets.h"
#include "sensor/file_bytes.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using testing::HasSubstr;

DepthBias random_bias(test::Random& random, int columns = 5, int rows = 4) {
    DepthBias bias{64, 48, columns, rows, {}};
    for (int i = 0; i < columns * rows; ++i) {
        bias.per_m.push_back(static_cast<float>(random.real(-0.05, 0.05)));
    }
    return bias;
}

Image<float> random_depth(test::Random& random, int width, int height) {
    Image<float> depth(width, height);
    for (float& z : depth.pixels()) z = static_cast<float>(random.real(0.3, 8));
    depth.pixels()[3] = 0;
    depth.pixels()[4] = std::numeric_limits<float>::quiet_NaN();
    return depth;
}

TEST(BiasTable, DoesWhatTheSlowWayDoes) {
    test::Random random(3);
    for (const auto& [columns, rows] : {std::pair(5, 4), std::pair(1, 1), std::pair(20, 1)}) {
        const DepthBias bias = random_bias(random, columns, rows);
        const Image<float> depth = random_depth(random, 64, 48);
        Image<float> slow = depth;
        slow.pixels()[4] = 0;  // the slow way leaves NaN alone
        Image<float> fast = depth;
        bias.correct(slow);
        BiasTable(bias, 64, 48).correct(fast);
        for (std::size_t i = 0; i < slow.size(); ++i) {
            ASSERT_NEAR(fast.pixels()[i], slow.pixels()[i], 2e-6 * slow.pixels()[i]) << i;
        }
        EXPECT_EQ(fast.pixels()[3], 0);
    }
}

// A surface seen with the bias in it comes out where it is.
TEST(BiasTable, UndoesTheBias) {
    test::Random random(5);
    const DepthBias bias = random_bias(random);
    for (const double z : {0.5, 1.7, 4.0}) {
        Image<float> depth(64, 48);
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                depth.at(x, y) = static_cast<float>(1 / (1 / z + bias.at(x, y)));
            }
        }
        BiasTable(bias, 64, 48).correct(depth);
        for (const float corrected : depth.pixels()) ASSERT_NEAR(corrected, z, 2e-6 * z * z + 2e-6);
    }
}

TEST(BiasTable, FitsTheSameCameraReadOutAtAnotherSize) {
    test::Random random(7);
    const DepthBias bias = random_bias(random);
    Image<float> depth(32, 24, 2.0f);
    BiasTable(bias, 32, 24).correct(depth);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(10, 20), std::pair(31, 23)}) {
        // Pixel edges keep their place: this one covers two by two of the larger picture.
        const double at = bias.at(2 * x + 0.5, 2 * y + 0.5);
        EXPECT_NEAR(depth.at(x, y), 1 / (0.5 - at), 1e-5);
    }
}

TEST(BiasTable, WhatCannotBeIsNoReading) {
    DepthBias bias{2, 1, 1, 1, {0.6f}};
    Image<float> depth(2, 1);
    depth.at(0, 0) = 1.0f;
    depth.at(1, 0) = 2.0f;  // 1/z would turn negative
    BiasTable(bias, 2, 1).correct(depth);
    EXPECT_NEAR(depth.at(0, 0), 2.5, 1e-5);
    EXPECT_EQ(depth.at(1, 0), 0);
}

TEST(BiasFile, RoundTripGivesTheSameBits) {
    test::Random random(9);
    const test::TempDir folder;
    const DepthBias bias = random_bias(random, 20, 15);
    const auto rig_file = folder / "A22.json";
    EXPECT_EQ(bias_file_beside(rig_file), folder / "A22.bias.json");
    EXPECT_FALSE(bias_beside(rig_file, "A22").value());
    ASSERT_TRUE(write_bias_file(bias_file_beside(rig_file), bias, "A22"));
    EXPECT_EQ(bias_beside(rig_file, "A22").value(), bias);
    EXPECT_EQ(bias_beside(rig_file, "").value(), bias);
    const auto other = bias_beside(rig_file, "B7");
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().to_string(), HasSubstr("this is the depth bias of A22, not of B7"));
}

TEST(BiasFile, SaysWhatIsWrong) {
    const auto complaint = [](const std::string& text) {
        const auto read = bias_from_json(text, "", "here");
        return read ? std::string("none") : read.error().to_string();
    };
    const std::string head = "{\"kinoscope_depth_bias\": 1, \"size\": [4, 4], ";
    EXPECT_EQ(complaint(head + "\"cells\": [1, 2], \"per_m\": [0.1, -0.1]}"), "none");
    EXPECT_THAT(complaint(head + "\"cells\": [1, 2], \"per_m\": [0.1]}"), HasSubstr("per_m"));
    EXPECT_THAT(complaint(head + "\"cells\": [1, 1], \"per_m\": [1.5]}"),
                HasSubstr("between -1 and 1 per metre"));
    EXPECT_THAT(complaint(head + "\"cells\": [0, 1], \"per_m\": []}"), HasSubstr("cells"));
    EXPECT_THAT(complaint(head + "\"cells\": [1, 1], \"per_m\": [0], \"extra\": 1}"),
                HasSubstr("extra"));
    EXPECT_THAT(complaint("{\"kinoscope_depth_bias\": 2}"), HasSubstr("kinoscope_depth_bias"));
    EXPECT_THAT(complaint("[]"), HasSubstr("here"));
}

TEST(BiasFile, MutationsBreakNothing) {
    const auto seed = read_file_bytes("tests/data/fuzz/depth_bias/small.json", 4096).value();
    test::Random random(11);
    for (int i = 0; i < 3000; ++i) {
        auto bytes = seed;
        const int changes = random.integer(1, 4);
        for (int k = 0; k < changes && !bytes.empty(); ++k) {
            const auto at = bytes.begin() + random.integer(0, static_cast<int>(bytes.size()) - 1);
            switch (random.integer(0, 2)) {
                case 0:
                    *at = static_cast<std::uint8_t>("0123456789[]{},:.-e\""[random.integer(0, 19)]);
                    break;
                case 1:
                    bytes.erase(at);
                    break;
                default:
                    bytes.insert(at, static_cast<std::uint8_t>(random.integer(32, 126)));
            }
        }
        fuzz::depth_bias(bytes);
    }
}

// The hook that the viewer plays through.
TEST(BiasInTheProcessor, DepthComesOutCorrected) {
    RigParameters rig = default_kinect1_rig(64, 48);
    rig.color.reset();
    test::Random random(13);
    const DepthBias bias = random_bias(random);
    const auto depth = std::make_shared<DepthFrame>();
    depth->raw = Image<std::uint16_t>(64, 48);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            depth->raw.at(x, y) =
                static_cast<std::uint16_t>(std::lround(1000 / (1 / 2.0 + bias.at(x, y))));
        }
    }
    depth->raw.at(5, 5) = 0;
    FrameSet set;
    set.depth = depth;
    for (const char* filters : {"", "spatial"}) {
        auto chain = DepthFilterChain::parse(filters);
        ASSERT_TRUE(chain);
        auto processor = Processor::create(rig, {}, std::move(*chain), bias);
        ASSERT_TRUE(processor);
        const auto frame = processor->process(set);
        ASSERT_TRUE(frame);
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) {
                const float z = frame->surface->depth_m.at(x, y);
                EXPECT_TRUE(z == 0 || std::abs(z - 2) < 0.002) << z;
            }
        }
        EXPECT_GT(frame->valid_points, 64 * 48 - 60);
    }
    auto plain = Processor::create(rig);
    EXPECT_GT(std::abs(plain->process(set)->surface->depth_m.at(0, 0) - 2), 0.01);
}

}  // namespace
}  // namespace kino
