#include "tests/support/golden.h"

#include <gmock/gmock.h>

#include <string>

#include "sensor/png_io.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino::test {
namespace {

using testing::HasSubstr;

class Golden : public testing::Test {
  protected:
    [[nodiscard]] GoldenPlace place(bool update = false) const {
        return {.stored = dir_ / "stored", .failures = dir_ / "failures", .update = update};
    }
    TempDir dir_;
    Image<Rgba8> picture_ = random_picture(48, 32, 7);
};

TEST_F(Golden, StoredThenMatched) {
    EXPECT_TRUE(matches_golden("a", picture_, {}, place(true)));
    EXPECT_TRUE(matches_golden("a", picture_, {}, place()));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "failures"));
}

TEST_F(Golden, MissingOneFailsAndLeavesTheActualPicture) {
    const auto result = matches_golden("new", picture_, {}, place());
    EXPECT_FALSE(result);
    EXPECT_THAT(result.message(), HasSubstr("KINO_UPDATE_GOLDENS=1"));
    const auto actual = read_png_rgba8(dir_ / "failures/new-actual.png");
    ASSERT_TRUE(actual) << actual.error().to_string();
    EXPECT_EQ(*actual, picture_);
}

TEST_F(Golden, ADifferenceFailsAndIsDrawn) {
    ASSERT_TRUE(matches_golden("a", picture_, {}, place(true)));
    auto changed = picture_;
    for (int x = 10; x < 20; ++x) changed.at(x, 12) = {1, 255, 3, 255};
    EXPECT_FALSE(matches_golden("a", changed, {}, place()));
    const auto drawn = read_png_rgba8(dir_ / "failures/a-difference.png");
    ASSERT_TRUE(drawn) << drawn.error().to_string();
    EXPECT_EQ(*drawn, difference_picture(changed, picture_));
}

TEST_F(Golden, AnotherSizeFails) {
    ASSERT_TRUE(matches_golden("a", picture_, {}, place(true)));
    const auto result = matches_golden("a", random_picture(48, 31, 7), {}, place());
    EXPECT_FALSE(result);
    EXPECT_THAT(result.message(), HasSubstr("48x31 and 48x32"));
}

TEST_F(Golden, ABrokenFileFails) {
    static_cast<void>(dir_.write("stored/a.png", "not a picture"));
    EXPECT_FALSE(matches_golden("a", picture_, {}, place()));
}

TEST(TempDir, IsFreshAndGoesAway) {
    std::filesystem::path first;
    {
        const TempDir a;
        const TempDir b;
        EXPECT_NE(a.path(), b.path());
        first = a.path();
        EXPECT_EQ(read_bytes(a.write("x/y.txt", std::string("1\0 2", 4))), std::string("1\0 2", 4));
    }
    EXPECT_FALSE(std::filesystem::exists(first));
}

TEST(Random, SplitMix64ReferenceValues) {
    // Published test vector of the generator, seed 1234567.
    Random random(1234567);
    EXPECT_EQ(random.bits(), 6457827717110365317u);
    EXPECT_EQ(random.bits(), 3203168211198807973u);
    EXPECT_EQ(random.bits(), 9817491932198370423u);
}

TEST(Random, StaysInItsRanges) {
    Random random(3);
    bool low = false;
    bool high = false;
    for (int i = 0; i < 1000; ++i) {
        const double real = random.real(-2, 3);
        EXPECT_TRUE(real >= -2 && real < 3);
        const int integer = random.integer(-1, 1);
        EXPECT_TRUE(integer >= -1 && integer <= 1);
        low = low || integer == -1;
        high = high || integer == 1;
    }
    EXPECT_TRUE(low && high);
}

}  // namespace
}  // namespace kino::test
