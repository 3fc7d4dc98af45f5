#include "skeleton/forest/default_forest.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "forest_samples.h"
#include "skeleton/actors/actor_images.h"
#include "skeleton/forest/body_part.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/part_labeller.h"
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

// People, clothes and poses that no training picture shows. The bound is a little below what was
// measured when the forest was made (docs/accuracy/forest.md has more pictures, and larger ones).
TEST(DefaultForest, LabelsPeopleWhomItHasNotSeen) {
    const auto forest = default_forest();
    ASSERT_TRUE(forest.has_value());
    const PartLabeller labeller(**forest);
    ActorImagesOptions options;
    options.seed = 3;
    options.count = 60;
    options.held_out = true;
    const auto images = ActorImages::create(options);
    ASSERT_TRUE(images.has_value());
    std::size_t right = 0, mirrored_right = 0, all = 0;
    for (std::int64_t i = 0; i < options.count; ++i) {
        TrainingImage image;
        ASSERT_TRUE((*images)->load(i, image).has_value());
        Image<std::uint8_t> mask(image.label.width(), image.label.height());
        for (std::size_t p = 0; p < mask.size(); ++p)
            mask.pixels()[p] = image.label.pixels()[p] == kNotBody ? 0 : 1;
        BodyDepth body;
        body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1,
                 image.focal_px);
        PartLabels labels;
        labeller.label(body, labels);
        for (std::size_t p = 0; p < body.count(); ++p) {
            const auto truth =
                coarse_part_of(static_cast<BodyPart>(image.label.at(body.x(p), body.y(p))));
            const auto said = coarse_part_of(static_cast<BodyPart>(labels.label[p]));
            right += said == truth ? 1 : 0;
            mirrored_right += said == mirrored(truth) ? 1 : 0;
        }
        all += body.count();
    }
    const double share = static_cast<double>(right) / static_cast<double>(all);
    EXPECT_GT(share, 0.70);
    EXPECT_LT(static_cast<double>(mirrored_right) / static_cast<double>(all), share - 0.15);
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
