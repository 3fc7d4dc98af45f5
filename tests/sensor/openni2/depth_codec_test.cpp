#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "sensor/openni2/oni_depth_codec.h"

namespace kino {
namespace {

using Words = std::vector<std::uint16_t>;
using Bytes = std::vector<std::uint8_t>;

void expect_round_trip(const Words& pixels) {
    const auto coded = encode_16z_table(pixels);
    ASSERT_TRUE(coded);
    Words back(pixels.size(), 0xBEEF);
    ASSERT_TRUE(decode_16z(*coded, true, back));
    EXPECT_EQ(back, pixels);
    EXPECT_TRUE(check_16z(*coded, true, pixels.size()));
    EXPECT_FALSE(check_16z(*coded, true, pixels.size() + 1));
    EXPECT_FALSE(check_16z(*coded, true, pixels.size() - 1));
}

TEST(OniDepthCodec, EveryFrameComesBack) {
    std::mt19937 random(1);
    for (int round = 0; round < 400; ++round) {
        Words pixels(1 + random() % 900);
        const auto spread = std::uint32_t{1} << random() % 17;
        const auto run = 1 + random() % 60;
        std::uint16_t value = static_cast<std::uint16_t>(random());
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (random() % run == 0) value = static_cast<std::uint16_t>(value + random() % spread);
            pixels[i] = value;
        }
        expect_round_trip(pixels);
        if (HasFailure()) FAIL() << "round " << round;
    }
}

TEST(OniDepthCodec, AllEndsOfARun) {
    // Runs of every length against the half byte that may wait before, after and at the end.
    for (int lead = 0; lead < 4; ++lead) {
        for (int length = 0; length < 70; ++length) {
            for (int tail = 0; tail < 4; ++tail) {
                Words pixels(1, 1000);
                for (int i = 0; i < lead; ++i)
                    pixels.push_back(static_cast<std::uint16_t>(1001 + i));
                pixels.insert(pixels.end(), static_cast<std::size_t>(length), pixels.back());
                for (int i = 0; i < tail; ++i)
                    pixels.push_back(static_cast<std::uint16_t>(2000 + i));
                expect_round_trip(pixels);
            }
        }
    }
}

TEST(OniDepthCodec, AsManyValuesAsALongNumberHolds) {
    Words pixels;
    for (unsigned i = 0; i < 32768; ++i) pixels.push_back(static_cast<std::uint16_t>(2 * i));
    std::shuffle(pixels.begin(), pixels.end(), std::mt19937(2));
    expect_round_trip(pixels);
    pixels.push_back(1);
    EXPECT_FALSE(encode_16z_table(pixels));
}

TEST(OniDepthCodec, BytesByHand) {
    // Table 100, 200, 300; first 0; then +1 and a lone +1: differences -1, -1 as old less new.
    const Bytes table = {3, 0, 100, 0, 200, 0, 0x2C, 1, 0, 0, 0x55, 0xE1};
    Words out(5);
    ASSERT_TRUE(decode_16z(table, true, out));
    EXPECT_EQ(out, (Words{100, 200, 300, 300, 300}));
    // Without: first 1000, a long number 0x0203 after a half byte 6, a difference of +10, a lone 7.
    const Bytes plain = {0xE8, 3, 0x6F, 2, 3, 0xFF, 182, 0x5D};
    out.assign(5, 0);
    ASSERT_TRUE(decode_16z(plain, false, out));
    EXPECT_EQ(out, (Words{1000, 1000, 0x203, 0x20D, 0x20E}));
}

TEST(OniDepthCodec, PlacesOutsideTheTableAreRefused) {
    EXPECT_FALSE(check_16z(Bytes{2, 0, 1, 0, 2, 0, 2, 0}, true, 1));
    EXPECT_FALSE(check_16z(Bytes{1, 0, 1, 0, 0, 0, 0x5D}, true, 2));
    EXPECT_FALSE(check_16z(Bytes{9, 0, 1, 0, 0, 0}, true, 1)) << "table cut off";
    EXPECT_FALSE(check_16z(Bytes{0, 0, 0xFF}, false, 2)) << "long number cut off";
    EXPECT_FALSE(check_16z(Bytes{}, false, 0));
}

}  // namespace
}  // namespace kino
