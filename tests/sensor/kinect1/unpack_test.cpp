#include "sensor/kinect1/unpack.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "bit_reference.h"
#include "support/random.h"

namespace kino::kinect1 {
namespace {

using Values = std::vector<std::uint16_t>;

// On the heap and exactly as long as the packed values, so that ASan sees a byte too many.
std::unique_ptr<std::uint8_t[]> random_bytes(std::size_t n, std::uint64_t seed) {
    test::Random random(seed);
    std::unique_ptr<std::uint8_t[]> bytes(new std::uint8_t[n]);
    for (std::size_t i = 0; i < n; ++i) {
        // Long runs of ones and zeros, among others, so that the extremes occur.
        const int kind = random.integer(0, 3);
        bytes[i] = kind == 0 ? 0xFF : kind == 1 ? 0 : static_cast<std::uint8_t>(random.bits());
    }
    return bytes;
}

class UnpackTest : public testing::TestWithParam<const Unpacker*> {
  protected:
    void SetUp() override {
        if (GetParam() == &kAvx2Unpacker && &best_unpacker() != &kAvx2Unpacker) {
            GTEST_SKIP() << "no AVX2 here";
        }
    }
};

TEST_P(UnpackTest, ElevenBitsAgreeWithBitByBitAtEveryLength) {
    for (std::size_t n = 0; n <= 640; n += 8) {
        const std::size_t size = n * 11 / 8;
        const auto bytes = random_bytes(size, n);
        Values out(n + 1, 0xABCD);
        GetParam()->eleven(bytes.get(), n, out.data());
        for (std::size_t i = 0; i < n; ++i) {
            ASSERT_EQ(out[i], test::value_at({bytes.get(), size}, i, 11)) << i << " of " << n;
        }
        EXPECT_EQ(out[n], 0xABCD);
    }
}

TEST_P(UnpackTest, TenBitsAgreeWithBitByBitAtEveryLength) {
    for (std::size_t n = 0; n <= 320; n += 4) {
        const std::size_t size = n * 10 / 8;
        const auto bytes = random_bytes(size, 1000 + n);
        Values plain(n + 1, 0xABCD);
        Values doubled(n + 1, 0xABCD);
        GetParam()->ten(bytes.get(), n, plain.data());
        GetParam()->ten_doubled(bytes.get(), n, doubled.data());
        for (std::size_t i = 0; i < n; ++i) {
            const unsigned value = test::value_at({bytes.get(), size}, i, 10);
            ASSERT_EQ(plain[i], value) << i << " of " << n;
            ASSERT_EQ(doubled[i], value == 1023 ? 2047 : 2 * value) << i << " of " << n;
        }
        EXPECT_EQ(plain[n], 0xABCD);
        EXPECT_EQ(doubled[n], 0xABCD);
    }
}

TEST_P(UnpackTest, AWholeFrameOfEveryValue) {
    constexpr std::size_t kPixels = 307200;
    constexpr std::size_t kSize = kPixels * 11 / 8;
    const auto bytes = random_bytes(kSize, 7);
    Values out(kPixels);
    GetParam()->eleven(bytes.get(), kPixels, out.data());
    std::vector<bool> seen(2048);
    for (std::size_t i = 0; i < kPixels; ++i) {
        ASSERT_EQ(out[i], test::value_at({bytes.get(), kSize}, i, 11)) << i;
        seen[out[i]] = true;
    }
    EXPECT_TRUE(seen[0] && seen[2047]);
}

INSTANTIATE_TEST_SUITE_P(All, UnpackTest, testing::Values(&kPortableUnpacker, &kAvx2Unpacker),
                         [](const auto& test) { return std::string(test.param->name); });

}  // namespace
}  // namespace kino::kinect1
