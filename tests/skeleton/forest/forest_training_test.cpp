#include "skeleton/forest/forest_training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "forest_samples.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/split_search.h"

namespace kino {
namespace {

// Upright cards at random places and distances. The label says whether a pixel lies within 100 mm
// of the card's left edge: decided by one probe, "is there body 100 mm to the left".
class Cards : public TrainingImages {
  public:
    explicit Cards(int count) : count_(count) {}
    [[nodiscard]] std::vector<std::string> labels() const override { return {"edge", "rest"}; }
    [[nodiscard]] std::int64_t count() const override { return count_; }
    [[nodiscard]] Result<void> load(std::int64_t index, TrainingImage& out) const override {
        test::Random random(100 + static_cast<std::uint64_t>(index));
        out.focal_px = 100;
        out.depth_mm.resize(64, 48);
        out.depth_mm.fill(0);
        out.label.resize(64, 48);
        out.label.fill(kNotBody);
        const int left = random.integer(1, 10);
        const int right = random.integer(40, 62);
        for (int y = 5; y < 43; ++y)
            for (int x = left; x < right; ++x) {
                out.depth_mm.at(x, y) = 1000;  // 100 mm are 10 px
                out.label.at(x, y) = x < left + 10 ? 0 : 1;
            }
        return {};
    }

  private:
    int count_;
};

// Two people's balls: many labels, not separable.
class Balls : public TrainingImages {
  public:
    explicit Balls(int count, int fail_at = -1) : count_(count), fail_at_(fail_at) {}
    [[nodiscard]] std::vector<std::string> labels() const override {
        return {"low", "middle", "high", "near"};
    }
    [[nodiscard]] std::int64_t count() const override { return count_; }
    [[nodiscard]] Result<void> load(std::int64_t index, TrainingImage& out) const override {
        if (index >= fail_at_ && fail_at_ >= 0) return fail("no such picture", "here");
        test::BodyPicture bodies =
            test::random_bodies(50 + static_cast<std::uint64_t>(index), 80, 60);
        out.focal_px = 80;
        out.label.resize(80, 60);
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 80; ++x) {
                const int z = bodies.depth_mm.at(x, y);
                const int label = z < 1500 ? 3 : (59 - y) / 20;
                out.label.at(x, y) =
                    bodies.body.at(x, y) == 0 ? kNotBody : static_cast<std::uint8_t>(label);
            }
        out.depth_mm = std::move(bodies.depth_mm);
        return {};
    }

  private:
    int count_, fail_at_;
};

ForestTraining small_training() {
    ForestTraining t;
    t.trees = 2;
    t.depth = 6;
    t.pixels_per_image = 300;
    t.features = 40;
    t.thresholds = 10;
    t.reach_mm = 300;
    return t;
}

double accuracy(const Forest& forest, const TrainingImages& images) {
    const PartLabeller labeller(forest);
    std::size_t right = 0, all = 0;
    for (std::int64_t i = 0; i < images.count(); ++i) {
        TrainingImage image;
        EXPECT_TRUE(images.load(i, image).has_value());
        Image<std::uint8_t> mask(image.label.width(), image.label.height());
        for (int y = 0; y < mask.height(); ++y)
            for (int x = 0; x < mask.width(); ++x)
                mask.at(x, y) = image.label.at(x, y) == kNotBody ? 0 : 1;
        BodyDepth body;
        body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1,
                 image.focal_px);
        PartLabels labels;
        labeller.label(body, labels);
        for (std::size_t p = 0; p < body.count(); ++p)
            right += labels.label[p] == image.label.at(body.x(p), body.y(p)) ? 1 : 0;
        all += body.count();
    }
    return static_cast<double>(right) / static_cast<double>(all);
}

TEST(ForestTraining, LearnsASeparableLabellingWithoutAnError) {
    const Cards cards(12);
    ForestTraining training = small_training();
    training.trees = 1;
    training.features = 400;
    const auto forest = train_forest(cards, training);
    ASSERT_TRUE(forest.has_value()) << forest.error().to_string();
    EXPECT_EQ(accuracy(*forest, cards), 1.0);
    EXPECT_EQ(forest->labels, cards.labels());
}

TEST(ForestTraining, DeeperTreesAndMoreOfThemFitBetter) {
    const Balls balls(10);
    ForestTraining training = small_training();
    training.min_samples = 2;
    training.pixels_per_image = 5000;
    training.depth = 1;
    const double shallow = accuracy(train_forest(balls, training).value(), balls);
    training.depth = 14;
    const double deep = accuracy(train_forest(balls, training).value(), balls);
    EXPECT_GT(deep, shallow + 0.1);
    EXPECT_GT(deep, 0.8);
}

TEST(ForestTraining, SameSeedGivesTheSameBytesOnAnyNumberOfThreadsAndInAnyMemory) {
    const Balls balls(9);
    ForestTraining training = small_training();
    training.balanced_share = 0.3;
    training.leaf_pixels_per_image = 500;
    const auto bytes = [&] { return forest_to_bytes(train_forest(balls, training).value()); };
    const auto once = bytes();
    EXPECT_EQ(bytes(), once);
    training.threads = 4;
    EXPECT_EQ(bytes(), once);
    training.block_images = 2;
    EXPECT_EQ(bytes(), once);
    training.histogram_bytes = 1;  // a node a pass
    EXPECT_EQ(bytes(), once);
    training.seed = 2;
    EXPECT_NE(bytes(), once);
}

TEST(ForestTraining, KeepsToTheBoundOfItsHistograms) {
    const Balls balls(4);
    ForestTraining training = small_training();
    training.trees = 1;
    const SplitSpace space{training.features, training.thresholds, 4, 300, 400};
    training.histogram_bytes = 3 * SplitSearch::bytes_per_node(space);
    std::map<int, std::size_t> open;
    training.progress = [&](const TrainingProgress& p) {
        EXPECT_LE(p.nodes_open - open[p.level], 3u);
        open[p.level] = p.nodes_open;
        EXPECT_EQ(p.samples, 4u * 300);
    };
    ASSERT_TRUE(train_forest(balls, training).has_value());
    EXPECT_GT(open[3], 3u);
}

TEST(ForestTraining, TreesTakeTheirOwnPictures) {
    const Balls balls(20);
    ForestTraining training = small_training();
    training.images_per_tree = 10;
    std::vector<std::uint64_t> samples;
    training.progress = [&](const TrainingProgress& p) { samples.push_back(p.samples); };
    const auto forest = train_forest(balls, training);
    ASSERT_TRUE(forest.has_value());
    for (const std::uint64_t n : samples) EXPECT_EQ(n, 3000u);
    EXPECT_NE(forest->trees[0], forest->trees[1]);
    // The second tree reaches picture 10, the first does not.
    training.trees = 1;
    EXPECT_TRUE(train_forest(Balls(20, 10), training).has_value());
    training.trees = 2;
    const auto broken = train_forest(Balls(20, 10), training);
    ASSERT_FALSE(broken.has_value());
    EXPECT_EQ(broken.error().what, "no such picture");
}

TEST(ForestTraining, RefusesWhatCannotWork) {
    ForestTraining training = small_training();
    EXPECT_FALSE(train_forest(Balls(0), training).has_value());
    training.thresholds = 65;
    EXPECT_FALSE(train_forest(Balls(2), training).has_value());
    training = small_training();
    training.balanced_share = std::nan("");
    EXPECT_FALSE(train_forest(Balls(2), training).has_value());
}

TEST(TrainingBlock, DrawsWithoutReplacementAndBalances) {
    const Balls balls(1);
    TrainingBlock block;
    ASSERT_TRUE(block.load(balls, 0, 1, {1, 0, 400, 0}, 1).has_value());
    std::set<std::uint32_t> places;
    for (const auto& s : block.samples()[0]) places.insert(s.xy);
    EXPECT_EQ(places.size(), 400u);
    ASSERT_TRUE(block.load(balls, 0, 1, {1, 0, 1 << 20, 0}, 1).has_value());
    std::array<int, 4> all{};
    for (const auto& s : block.samples()[0]) ++all[s.label];
    ASSERT_TRUE(block.load(balls, 0, 1, {1, 0, 4000, 1.0}, 1).has_value());
    std::array<int, 4> even{};
    for (const auto& s : block.samples()[0]) ++even[s.label];
    const int present =
        static_cast<int>(std::count_if(all.begin(), all.end(), [](int n) { return n > 0; }));
    ASSERT_GT(present, 2);
    for (std::size_t l = 0; l < 4; ++l)
        EXPECT_NEAR(even[l], all[l] > 0 ? 4000.0 / present : 0, 6 * std::sqrt(4000.0 / present));
}

// Definition by entropies, each candidate on its own, from the samples themselves.
double entropy(const std::vector<double>& counts) {
    double n = 0, h = 0;
    for (const double c : counts) n += c;
    for (const double c : counts)
        if (c > 0) h -= c / n * std::log2(c / n);
    return h;
}

TEST(SplitSearch, GainEqualsASlowReference) {
    const Balls balls(3);
    const SplitSpace space{25, 8, 4, 400, 300};
    const std::vector<SplitCandidates> candidates{draw_candidates(space, 1, 0, 1)};
    TrainingBlock block;
    ASSERT_TRUE(block.load(balls, 0, 3, {1, 0, 500, 0}, 1).has_value());
    SplitSearch search(space, candidates);
    for (const auto& list : block.samples()) {
        search.count(0, list, block, 0, 10);
        search.count(0, list, block, 10, 25);
    }
    double best_gain = 0;
    ForestFeature best_feature;
    int best_threshold = 0;
    for (std::size_t f = 0; f < 25; ++f)
        for (std::size_t t = 0; t < 8; ++t) {
            const int threshold = candidates[0].thresholds_mm[f * 8 + t];
            std::vector<double> left(4), right(4), both(4);
            double n = 0, n_left = 0;
            for (const auto& list : block.samples())
                for (const TrainingSample& s : list) {
                    const bool goes_right = feature_response(block.image(s.image), s.xy, s.scale,
                                                             candidates[0].features[f]) > threshold;
                    ++(goes_right ? right : left)[s.label];
                    ++both[s.label];
                    ++n;
                    n_left += goes_right ? 0 : 1;
                }
            const double gain =
                entropy(both) - n_left / n * entropy(left) - (n - n_left) / n * entropy(right);
            if (gain <= best_gain + 1e-12) continue;
            best_gain = gain;
            best_feature = candidates[0].features[f];
            best_threshold = threshold;
        }
    const BestSplit best = search.best(0);
    EXPECT_NEAR(best.gain_bits, best_gain, 1e-10);
    EXPECT_EQ(best.feature, best_feature);
    EXPECT_EQ(best.threshold_mm, best_threshold);
    EXPECT_GT(best_gain, 0.05);
    std::vector<std::uint64_t> sum = best.left;
    for (std::size_t l = 0; l < 4; ++l) sum[l] += best.right[l];
    EXPECT_EQ(sum, search.totals(0));
}

// Thresholds of a few mm, so that many responses lie on them.
TEST(SplitSearch, CountsTheSidesThatTheWalkTakes) {
    const Balls balls(3);
    TrainingBlock block;
    ASSERT_TRUE(block.load(balls, 0, 3, {1, 0, 500, 0}, 1).has_value());
    for (std::uint64_t path = 1; path < 20; ++path) {
        const SplitSpace space{5, 4, 4, 100, 6};
        SplitSearch search(space, {draw_candidates(space, 1, 0, path)});
        for (const auto& list : block.samples()) search.count(0, list, block, 0, 5);
        const BestSplit best = search.best(0);
        std::vector<ForestNode> nodes(3);
        nodes[0] = {best.feature, best.threshold_mm, 1, -1};
        block.walk(nodes, 1);
        std::vector<std::uint64_t> left(4), right(4);
        for (const auto& list : block.samples())
            for (const TrainingSample& s : list) ++(s.node == 1 ? left : right)[s.label];
        EXPECT_EQ(left, best.left);
        EXPECT_EQ(right, best.right);
    }
}

TEST(SplitSearch, CandidatesDependOnSeedTreeAndPathOnly) {
    const SplitSpace space{50, 20, 4, 600, 400};
    const auto a = draw_candidates(space, 1, 0, 5);
    EXPECT_EQ(draw_candidates(space, 1, 0, 5).features, a.features);
    EXPECT_EQ(draw_candidates(space, 1, 0, 5).thresholds_mm, a.thresholds_mm);
    EXPECT_NE(draw_candidates(space, 2, 0, 5).features, a.features);
    EXPECT_NE(draw_candidates(space, 1, 1, 5).features, a.features);
    EXPECT_NE(draw_candidates(space, 1, 0, 6).features, a.features);
    for (const ForestFeature& f : a.features) EXPECT_LE(std::hypot(f.u[0], f.u[1]), 2401);
    for (std::size_t f = 0; f < 50; ++f)
        EXPECT_TRUE(
            std::is_sorted(a.thresholds_mm.begin() + static_cast<std::ptrdiff_t>(20 * f),
                           a.thresholds_mm.begin() + static_cast<std::ptrdiff_t>(20 * f + 20)));
}

// What the trainer walks and what the labeller walks must be the same thing.
TEST(TrainingBlock, WalksAsTheLabellerDoes) {
    const Balls balls(3);
    const Forest forest = test::random_forest(21, 4, 1, 8);
    TrainingBlock block;
    ASSERT_TRUE(block.load(balls, 0, 3, {1, 0, 1 << 20, 0}, 2).has_value());
    block.walk(forest.trees[0].nodes, 2);
    const PartLabeller labeller(forest);
    for (std::size_t i = 0; i < 3; ++i) {
        TrainingImage image;
        ASSERT_TRUE(balls.load(static_cast<std::int64_t>(i), image).has_value());
        Image<std::uint8_t> mask(80, 60);
        for (std::size_t p = 0; p < mask.size(); ++p)
            mask.pixels()[p] = image.label.pixels()[p] == kNotBody ? 0 : 1;
        BodyDepth body;
        body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1, 80);
        PartLabels labels;
        labeller.label(body, labels);
        ASSERT_EQ(labels.label.size(), block.samples()[i].size());
        for (std::size_t p = 0; p < labels.label.size(); ++p)
            ASSERT_EQ(
                labels.leaf[0][p],
                forest.trees[0].nodes[static_cast<std::size_t>(block.samples()[i][p].node)].leaf);
    }
}

}  // namespace
}  // namespace kino
