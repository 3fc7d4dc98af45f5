#include "skeleton/forest/default_forest.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "forest_samples.h"
#include "skeleton/forest/body_part.h"
#include "skeleton/forest/forest_file.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

class DataFolder {
  public:
    explicit DataFolder(const std::filesystem::path& path) {
        setenv("KINOSCOPE_DATA", path.c_str(), 1);
    }
    DataFolder(const DataFolder&) = delete;
    DataFolder& operator=(const DataFolder&) = delete;
    ~DataFolder() { unsetenv("KINOSCOPE_DATA"); }
};

Forest ours(std::uint64_t seed) {
    Forest forest = test::random_forest(seed, kBodyPartCount, 1, 4);
    for (std::size_t l = 0; l < kBodyPartCount; ++l)
        forest.labels[l] = body_part_name(static_cast<BodyPart>(l));
    return forest;
}

TEST(DefaultForest, TheShippedOneIsFoundAndIsSmallEnough) {
    const auto forest = default_forest();
    ASSERT_TRUE(forest.has_value()) << forest.error().to_string();
    ASSERT_EQ((*forest)->labels.size(), static_cast<std::size_t>(kBodyPartCount));
    EXPECT_NE((*forest)->note.find("kinoscope train"), std::string::npos) << (*forest)->note;
    EXPECT_LT(forest_to_bytes(**forest).size(), 12'000'000u);
}

TEST(DefaultForest, TheNamedFolderComesFirst) {
    const test::TempDir folder;
    const DataFolder named(folder.path());
    ASSERT_EQ(default_forest_places().front(), folder.path() / "bodies.forest");
    const auto without = default_forest();
    ASSERT_TRUE(without.has_value());
    const Forest mine = ours(3);
    ASSERT_TRUE(write_forest(folder.path() / "bodies.forest", mine).has_value());
    const auto with = default_forest();
    ASSERT_TRUE(with.has_value()) << with.error().to_string();
    EXPECT_EQ(**with, mine);
}

TEST(DefaultForest, AForestOfOtherPartsIsRefused) {
    const test::TempDir folder;
    const DataFolder named(folder.path());
    Forest other = ours(4);
    std::swap(other.labels[0], other.labels[1]);
    ASSERT_TRUE(write_forest(folder.path() / "bodies.forest", other).has_value());
    const auto read = default_forest();
    ASSERT_FALSE(read.has_value());
    EXPECT_NE(read.error().to_string().find("bodies.forest"), std::string::npos);
}

}  // namespace
}  // namespace kino
