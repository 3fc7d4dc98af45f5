#include "skeleton/forest/part_labeller.h"

#include <gtest/gtest.h>

#include "forest_samples.h"

namespace kino {
namespace {

using test::BodyPicture;

bool have_avx2() {
#if defined(__x86_64__)
    return forest::avx2_functions() != nullptr && __builtin_cpu_supports("avx2") &&
           __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

// The definition in docs/forest.md in doubles, on the pictures themselves, pixel by pixel.
class SlowLabeller {
  public:
    SlowLabeller(const Forest& forest, const BodyPicture& picture, int which, double focal_px)
        : forest_(forest), picture_(picture), which_(which), focal_px_(focal_px) {}

    [[nodiscard]] double depth(int x, int y) const {
        if (!picture_.body.contains(x, y) || picture_.body.at(x, y) != which_) return 32767;
        const double z = picture_.depth_mm.at(x, y);
        return z > 0 && z < 32767 ? z : 32767;
    }

    [[nodiscard]] int label(int x, int y) const {
        std::vector<double> share(forest_.labels.size());
        const double scale =
            std::min(32767.0, std::floor(focal_px_ / depth(x, y) * 8192 + 0.5)) / 32768;
        const auto probe = [&](const std::array<std::int16_t, 2>& offset) {
            return depth(x + static_cast<int>(std::floor(offset[0] * scale + 0.5)),
                         y + static_cast<int>(std::floor(offset[1] * scale + 0.5)));
        };
        for (const ForestTree& tree : forest_.trees) {
            std::size_t at = 0;
            while (!tree.nodes[at].is_leaf()) {
                const ForestNode& n = tree.nodes[at];
                const bool right = probe(n.feature.u) - probe(n.feature.v) > n.threshold_mm;
                at = static_cast<std::size_t>(n.child + (right ? 1 : 0));
            }
            const auto& row = forest_.distributions[static_cast<std::size_t>(tree.nodes[at].leaf)];
            for (std::size_t l = 0; l < share.size(); ++l) share[l] += row[l];
        }
        return static_cast<int>(std::max_element(share.begin(), share.end()) - share.begin());
    }

  private:
    const Forest& forest_;
    const BodyPicture& picture_;
    int which_;
    double focal_px_;
};

struct Case {
    std::uint64_t seed;
    int labels, trees, depth, width, height;
    double focal_px;
};

class Labelling : public testing::TestWithParam<Case> {};

TEST_P(Labelling, FastAndPortablePathsEqualTheSlowReference) {
    const Case c = GetParam();
    const Forest forest = test::random_forest(c.seed, c.labels, c.trees, c.depth);
    ASSERT_EQ(forest_defect(forest), "");
    const PartLabeller portable(forest, forest::portable_functions());
    const BodyPicture picture = test::random_bodies(c.seed + 1, c.width, c.height);
    for (std::uint8_t which = 1; which <= 2; ++which) {
        BodyDepth body;
        body.set(std::as_const(picture.depth_mm).view(), std::as_const(picture.body).view(), which,
                 c.focal_px);
        ASSERT_GT(body.count(), 100u);
        PartLabels slow, fast;
        portable.label(body, slow);
        const SlowLabeller reference(forest, picture, which, c.focal_px);
        for (std::size_t i = 0; i < body.count(); ++i)
            ASSERT_EQ(slow.label[i], reference.label(body.x(i), body.y(i))) << i;
        if (!have_avx2()) continue;
        PartLabeller(forest, *forest::avx2_functions()).label(body, fast);
        EXPECT_EQ(fast.label, slow.label);
        EXPECT_EQ(fast.votes, slow.votes);
        EXPECT_EQ(fast.leaf, slow.leaf);
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Labelling,
                         testing::Values(Case{1, 14, 3, 10, 160, 120, 285.6},
                                         Case{2, 25, 3, 12, 157, 121, 525.0},
                                         Case{3, 32, 1, 6, 320, 240, 1000.0},
                                         Case{4, 2, 5, 9, 99, 140, 3000.0},
                                         Case{5, 17, 16, 4, 160, 120, 60.0}));

TEST(PartLabeller, ListsExactlyThePixelsOfTheBodyThatHaveAReading) {
    const BodyPicture picture = test::random_bodies(7, 120, 90);
    BodyDepth body;
    body.set(std::as_const(picture.depth_mm).view(), std::as_const(picture.body).view(), 2, 300);
    std::size_t at = 0;
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 120; ++x) {
            const int z = picture.depth_mm.at(x, y);
            const bool inside = picture.body.at(x, y) == 2 && z > 0 && z < 32767;
            EXPECT_EQ(body.depth_mm(x, y), inside ? z : 32767);
            if (!inside) continue;
            ASSERT_LT(at, body.count());
            EXPECT_EQ(body.x(at), x);
            EXPECT_EQ(body.y(at), y);
            EXPECT_EQ(body.scale(at), forest_scale(300, z));
            ++at;
        }
    EXPECT_EQ(at, body.count());
    EXPECT_EQ(body.depth_mm(-50, 1000), kForestBackgroundMm);
}

TEST(PartLabeller, ThinnedListsKeepTheLabels) {
    const PartLabeller labeller(test::random_forest(8, 14, 2, 8));
    const BodyPicture picture = test::random_bodies(9, 160, 120);
    const auto depth = std::as_const(picture.depth_mm).view();
    const auto mask = std::as_const(picture.body).view();
    BodyDepth all, some;
    all.set(depth, mask, 1, 300);
    some.set(depth, mask, 1, 300, 3);
    PartLabels of_all, of_some;
    labeller.label(all, of_all);
    labeller.label(some, of_some);
    std::size_t at = 0;
    for (std::size_t i = 0; i < all.count(); ++i) {
        if (all.x(i) % 3 != 0 || all.y(i) % 3 != 0) continue;
        ASSERT_LT(at, some.count());
        EXPECT_EQ(of_some.label[at], of_all.label[i]);
        ++at;
    }
    EXPECT_EQ(at, some.count());
}

TEST(PartLabeller, NobodyAndNoReadingsGiveNoPixels) {
    const PartLabeller labeller(test::random_forest(10, 14, 2, 5));
    BodyDepth body;
    PartLabels labels;
    labeller.label(body, labels);
    EXPECT_TRUE(labels.label.empty());
    for (const int z : {0, 32767, 65535}) {
        const Image<std::uint16_t> depth(40, 30, static_cast<std::uint16_t>(z));
        const Image<std::uint8_t> mask(40, 30, 1);
        body.set(depth.view(), mask.view(), 1, 300);
        labeller.label(body, labels);
        EXPECT_TRUE(labels.label.empty()) << z;
    }
    const Image<std::uint16_t> one(1, 1, 1);
    const Image<std::uint8_t> one_mask(1, 1, 1);
    body.set(one.view(), one_mask.view(), 1, 10000);
    labeller.label(body, labels);
    EXPECT_EQ(labels.label.size(), 1u);
}

TEST(PartLabeller, SharesAreTheMeanOfTheTrees) {
    const Forest forest = test::random_forest(11, 6, 3, 5);
    const PartLabeller labeller(forest);
    const BodyPicture picture = test::random_bodies(12, 80, 60);
    BodyDepth body;
    body.set(std::as_const(picture.depth_mm).view(), std::as_const(picture.body).view(), 1, 200);
    PartLabels labels;
    labeller.label(body, labels);
    std::vector<float> share(6);
    for (std::size_t i = 0; i < body.count(); ++i) {
        labeller.shares(labels, i, share);
        float sum = 0;
        for (const float s : share) sum += s;
        ASSERT_NEAR(sum, 1, 1e-5);
        const std::size_t best =
            static_cast<std::size_t>(std::max_element(share.begin(), share.end()) - share.begin());
        ASSERT_EQ(best, labels.label[i]);
        ASSERT_NEAR(share[best], labels.votes[i] / (3.0f * 255), 1e-6);
    }
}

TEST(PartLabeller, RoundedScaleMovesNoProbeByMoreThanATwentiethOfAPixel) {
    for (const double focal : {285.6, 571.26, 1000.0})
        for (int z = 500; z < 8000; z += 7) {
            const double ideal = 2400 / 4.0 * focal / z;
            EXPECT_NEAR(2400.0 * forest_scale(focal, z) / 32768, ideal, 0.05) << z;
        }
}

}  // namespace
}  // namespace kino
