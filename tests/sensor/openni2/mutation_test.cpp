#include <gtest/gtest.h>

#include <random>

#include "fuzz/oni_targets.h"
#include "oni_samples.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

Buffer sample(bool color) {
    const test::TempDir folder;
    test::write_sample(folder / "a.oni", 4, color, 8, 6);
    const std::string bytes = test::read_bytes(folder / "a.oni");
    return {bytes.begin(), bytes.end()};
}

TEST(OniMutations, TheWalkHoldsItsPromises) {
    std::mt19937 random(11);
    int accepted = 0;
    for (const bool color : {false, true}) {
        const Buffer whole = sample(color);
        ASSERT_TRUE(fuzz::oni(whole));
        for (int round = 0; round < 6000; ++round) {
            Buffer bytes = whole;
            for (unsigned i = 0; i < 1 + random() % 3; ++i) {
                const std::size_t at = random() % bytes.size();
                switch (random() % 5) {
                    case 0:
                        bytes[at] = static_cast<std::uint8_t>(random());
                        break;
                    case 1:
                        bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
                        break;
                    case 2:
                        bytes.resize(at + 1);
                        break;
                    case 3:
                        for (std::size_t b = at; b < std::min(at + 4, bytes.size()); ++b) {
                            bytes[b] = 0xFF;
                        }
                        break;
                    default:
                        bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
                }
            }
            accepted += fuzz::oni(bytes) ? 1 : 0;
        }
    }
    EXPECT_GT(accepted, 500) << "mutations that only spoil everything test little";
}

TEST(OniMutations, TheDepthCodecHoldsItsPromises) {
    std::mt19937 random(12);
    for (int round = 0; round < 20000; ++round) {
        Buffer bytes(random() % 200);
        for (std::uint8_t& byte : bytes) {
            byte = static_cast<std::uint8_t>(random() % 4 == 0 ? 0xE0 + random() % 32 : random());
        }
        fuzz::depth_codec(bytes);
    }
}

}  // namespace
}  // namespace kino
