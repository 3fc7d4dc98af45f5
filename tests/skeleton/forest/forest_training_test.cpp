#include "skeleton/forest/forest_training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "forest_samples.h"
#include "skeleton/forest/forest_file.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/split_search.h"
#include "skeleton/forest/training_set.h"
#include "skeleton/forest/tree_pruning.h"

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

TEST(ForestTraining, SameSeedGivesTheSameBytesOnAnyNumberOfThreads) {
    const Balls balls(9);
    ForestTraining training = small_training();
    training.balanced_share = 0.3;
    training.leaf_pixels_per_image = 500;
    const auto bytes = [&] { return forest_to_bytes(train_forest(balls, training).value()); };
    const auto once = bytes();
    EXPECT_EQ(bytes(), once);
    training.threads = 4;
    EXPECT_EQ(bytes(), once);
    training.seed = 2;
    EXPECT_NE(bytes(), once);
}

// Big nodes share out their features among the threads; small ones go to a thread each.
TEST(ForestTraining, BigNodesToo) {
    const Balls balls(60);
    ForestTraining training = small_training();
    training.trees = 1;
    training.pixels_per_image = 2000;
    std::size_t samples = 0;
    training.progress = [&](const TrainingProgress& p) { samples = p.samples; };
    const Forest once = train_forest(balls, training).value();
    EXPECT_GT(samples, 60000u);
    training.threads = 3;
    EXPECT_EQ(train_forest(balls, training).value(), once);
    training.node_samples = 1000;
    const Forest fewer = train_forest(balls, training).value();
    EXPECT_NE(fewer, once);
    EXPECT_NEAR(accuracy(fewer, balls), accuracy(once, balls), 0.03);
}

TEST(ForestTraining, FewerCandidatesFromTheDeepLevelOn) {
    const Balls balls(5);
    ForestTraining training = small_training();
    training.trees = 1;
    const Forest all = train_forest(balls, training).value();
    training.deep_features = 10;
    training.deep_level = 3;
    const Forest fewer = train_forest(balls, training).value();
    const auto& a = all.trees[0].nodes;
    const auto& b = fewer.trees[0].nodes;
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(a[i].feature, b[i].feature) << i;
    EXPECT_NE(all, fewer);
}

TEST(ForestTraining, LeavesAreFilledFromOtherPixelsWithEveryLabelTold) {
    const Balls balls(10);
    ForestTraining training = small_training();
    training.trees = 1;
    training.depth = 1;
    training.leaf_pixels_per_image = 1 << 20;
    const Forest forest = train_forest(balls, training).value();
    // The two leaves' distributions from all pixels, counted here.
    std::array<std::array<std::uint64_t, 4>, 2> counts{};
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 10, {9, 9, 1 << 20, 0}, 1).has_value());
    const ForestNode& root = forest.trees[0].nodes[0];
    ASSERT_FALSE(root.is_leaf());
    for (const TrainingSample& s : set.samples()) {
        const bool right = feature_response(set.images()[s.image], s.xy, s.scale, root.feature) >
                           root.threshold_mm;
        ++counts[right ? 1 : 0][s.label];
    }
    for (std::size_t side = 0; side < 2; ++side) {
        const auto leaf = static_cast<std::size_t>(forest.trees[0].nodes[1 + side].leaf);
        EXPECT_EQ(forest.distributions[leaf], quantized_distribution(counts[side].data(), 4));
    }
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

TEST(TrainingSet, DrawsWithoutReplacementAndBalances) {
    const Balls balls(1);
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 1, {1, 0, 400, 0}, 1).has_value());
    std::set<std::uint32_t> places;
    for (const auto& s : set.samples()) places.insert(s.xy);
    EXPECT_EQ(places.size(), 400u);
    ASSERT_TRUE(set.load(balls, 0, 1, {1, 0, 1 << 20, 0}, 1).has_value());
    std::array<int, 4> all{};
    for (const auto& s : set.samples()) ++all[s.label];
    ASSERT_TRUE(set.load(balls, 0, 1, {1, 0, 4000, 1.0}, 1).has_value());
    std::array<int, 4> even{};
    for (const auto& s : set.samples()) ++even[s.label];
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
    const SplitCandidates candidates = draw_candidates(space, 1, 0, 1);
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 3, {1, 0, 500, 0}, 1).has_value());
    const NodeSamples node{set.samples().data(), set.samples().data() + set.samples().size(), 1};
    double best_gain = 0;
    ForestFeature best_feature;
    int best_threshold = 0;
    for (std::size_t f = 0; f < 25; ++f)
        for (std::size_t t = 0; t < 8; ++t) {
            const int threshold = candidates.thresholds_mm[t];
            std::vector<double> left(4), right(4), both(4);
            double n = 0, n_left = 0;
            for (const TrainingSample& s : set.samples()) {
                const bool goes_right = feature_response(set.images()[s.image], s.xy, s.scale,
                                                         candidates.features[f]) > threshold;
                ++(goes_right ? right : left)[s.label];
                ++both[s.label];
                ++n;
                n_left += goes_right ? 0 : 1;
            }
            const double gain =
                entropy(both) - n_left / n * entropy(left) - (n - n_left) / n * entropy(right);
            if (gain <= best_gain + 1e-12) continue;
            best_gain = gain;
            best_feature = candidates.features[f];
            best_threshold = threshold;
        }
    ASSERT_GT(best_gain, 0.05);
    const std::vector<const forest::Functions*> all = {&forest::portable_functions(),
                                                       &forest::functions()};
    for (const auto* functions : all) {
        SplitSearch search(*functions);
        const BestSplit best = search.best(candidates, 4, node, set.images(), 0, 25);
        EXPECT_NEAR(best.gain_bits, best_gain, 1e-10);
        EXPECT_EQ(best.feature, best_feature);
        EXPECT_EQ(best.threshold_mm, best_threshold);
        std::vector<std::uint64_t> sum = best.left, totals(4);
        for (std::size_t l = 0; l < 4; ++l) sum[l] += best.right[l];
        for (const TrainingSample& s : set.samples()) ++totals[s.label];
        EXPECT_EQ(sum, totals);
        // In two parts, the better of them is the same.
        const BestSplit front = search.best(candidates, 4, node, set.images(), 0, 9);
        const BestSplit back = search.best(candidates, 4, node, set.images(), 9, 25);
        EXPECT_EQ(std::max(front.gain_bits, back.gain_bits), best.gain_bits);
        EXPECT_EQ((back.gain_bits > front.gain_bits ? back : front).feature, best.feature);
    }
}

// Thresholds of a few mm, so that many responses lie on them.
TEST(SplitSearch, CountsTheSidesThatTheWalkTakes) {
    const Balls balls(3);
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 3, {1, 0, 500, 0}, 1).has_value());
    const NodeSamples node{set.samples().data(), set.samples().data() + set.samples().size(), 1};
    SplitSearch search;
    for (std::uint64_t path = 1; path < 20; ++path) {
        const SplitSpace space{5, 4, 4, 100, 6};
        const BestSplit best =
            search.best(draw_candidates(space, 1, 0, path), 4, node, set.images(), 0, 5);
        ASSERT_GE(best.candidate, 0);
        ForestTree tree;
        tree.nodes = {{best.feature, best.threshold_mm, 1, -1}, {{}, 0, -1, 0}, {{}, 0, -1, 1}};
        const auto walkable = walk_nodes(tree);
        std::vector<std::uint64_t> left(4), right(4);
        for (const TrainingSample& s : set.samples()) {
            std::int32_t leaf = -1;
            forest::functions().walk(walkable.data(), set.images()[s.image], {&s.xy, &s.scale, 1},
                                     &leaf);
            ++(leaf == 0 ? left : right)[s.label];
        }
        EXPECT_EQ(left, best.left);
        EXPECT_EQ(right, best.right);
    }
}

TEST(SplitSearch, StrideTakesEveryNthSample) {
    const Balls balls(2);
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 2, {1, 0, 500, 0}, 1).has_value());
    const SplitCandidates candidates = draw_candidates({30, 9, 4, 300, 300}, 1, 0, 1);
    std::vector<TrainingSample> third;
    for (std::size_t i = 0; i < set.samples().size(); i += 3) third.push_back(set.samples()[i]);
    const TrainingSample* all = set.samples().data();
    SplitSearch search;
    const BestSplit a =
        search.best(candidates, 4, {all, all + set.samples().size(), 3}, set.images(), 0, 30);
    const BestSplit b = search.best(candidates, 4, {third.data(), third.data() + third.size(), 1},
                                    set.images(), 0, 30);
    EXPECT_EQ(a.gain_bits, b.gain_bits);
    EXPECT_EQ(a.left, b.left);
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
    EXPECT_EQ(a.thresholds_mm.size(), 20u);
    EXPECT_TRUE(std::is_sorted(a.thresholds_mm.begin(), a.thresholds_mm.end()));
    for (std::size_t f = 0; f < 50; ++f)
        EXPECT_EQ(a.features[f].v == (std::array<std::int16_t, 2>{}), f < 25) << f;
}

// Two equal splits below one that tells more: the cheapest go first, and a leaf takes the place of
// a whole subtree only when its parts are gone.
TEST(TreePruning, TakesBackTheSplitsThatTellLeast) {
    using Counts = std::vector<std::uint64_t>;
    std::vector<ForestNode> nodes(7);
    nodes[0].child = 1;
    nodes[1].child = 3;
    nodes[2].child = 5;
    const std::vector<Counts> counts = {{50, 50}, {40, 10}, {10, 40}, {25, 0},
                                        {15, 10}, {6, 19},  {4, 21}};
    const auto leaves = [&](std::size_t most) {
        std::vector<ForestNode> pruned = nodes;
        prune_tree(pruned, counts, most);
        std::vector<int> splits;
        for (std::size_t i = 0; i < 7; ++i)
            if (!pruned[i].is_leaf()) splits.push_back(static_cast<int>(i));
        return splits;
    };
    EXPECT_EQ(leaves(4), (std::vector<int>{0, 1, 2}));
    EXPECT_EQ(leaves(3), (std::vector<int>{0, 1}));
    EXPECT_EQ(leaves(2), (std::vector<int>{0}));
    EXPECT_EQ(leaves(1), (std::vector<int>{}));
}

TEST(TreePruning, AForestKeepsToItsLeavesAndMostOfItsAccuracy) {
    const Balls balls(10);
    ForestTraining training = small_training();
    training.depth = 12;
    training.trees = 1;
    const Forest whole = train_forest(balls, training).value();
    const auto leaves = [](const Forest& forest) { return (forest.trees[0].nodes.size() + 1) / 2; };
    training.max_leaves = leaves(whole) / 2;
    const Forest half = train_forest(balls, training).value();
    EXPECT_EQ(leaves(half), training.max_leaves);
    EXPECT_GT(accuracy(half, balls), accuracy(whole, balls) - 0.1);
}

// What the trainer walks and what the labeller walks must be the same thing.
TEST(TreePruning, AShallowerForestVotesAsTheMeanOfItsLeaves) {
    const Forest forest = test::random_forest(5, 3, 2, 6);
    const Forest same = shallower(forest, 6);
    for (std::size_t t = 0; t < 2; ++t) {
        const auto& a = forest.trees[t].nodes;
        const auto& b = same.trees[t].nodes;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_EQ(a[i].is_leaf(), b[i].is_leaf());
            if (a[i].is_leaf())
                EXPECT_EQ(forest.distributions[static_cast<std::size_t>(a[i].leaf)],
                          same.distributions[static_cast<std::size_t>(b[i].leaf)]);
            else
                EXPECT_EQ(a[i], b[i]);
        }
    }
    for (int depth = 0; depth < 6; ++depth) {
        const Forest cut = shallower(forest, depth);
        ASSERT_EQ(forest_defect(cut), "");
        for (const ForestTree& tree : cut.trees) EXPECT_LE(tree_depth(tree), depth);
    }
    const Forest stump = shallower(forest, 0);
    std::array<double, 3> mean{};
    const auto& nodes = forest.trees[0].nodes;
    std::vector<double> weight(nodes.size(), 1);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) {
            for (int side = 0; side < 2; ++side)
                weight[static_cast<std::size_t>(nodes[i].child + side)] = weight[i] / 2;
            continue;
        }
        for (std::size_t l = 0; l < 3; ++l)
            mean[l] += weight[i] * forest.distributions[static_cast<std::size_t>(nodes[i].leaf)][l];
    }
    const auto leaf = static_cast<std::size_t>(stump.trees[0].nodes[0].leaf);
    for (std::size_t l = 0; l < 3; ++l) EXPECT_NEAR(stump.distributions[leaf][l], mean[l], 1.0);
}

TEST(ForestTraining, RareLabelsOfALeafGetNoVotesIfSoAsked) {
    const Balls balls(10);
    ForestTraining training = small_training();
    const Forest all = train_forest(balls, training).value();
    training.min_votes = 20;
    const Forest few = train_forest(balls, training).value();
    const auto least = [](const Forest& forest) {
        int votes = kForestVotes;
        for (const LabelDistribution& row : forest.distributions)
            for (const std::uint8_t v : row)
                if (v > 0) votes = std::min<int>(votes, v);
        return votes;
    };
    EXPECT_LT(least(all), 10);
    EXPECT_GE(least(few), 20);
    EXPECT_LT(forest_to_bytes(few).size(), forest_to_bytes(all).size());
}

TEST(TrainingSet, RespondsAsTheLabellerDoes) {
    const Balls balls(3);
    const Forest forest = test::random_forest(21, 4, 1, 8);
    const auto& nodes = forest.trees[0].nodes;
    TrainingSet set;
    ASSERT_TRUE(set.load(balls, 0, 3, {1, 0, 1 << 20, 0}, 2).has_value());
    const PartLabeller labeller(forest);
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        TrainingImage image;
        ASSERT_TRUE(balls.load(i, image).has_value());
        Image<std::uint8_t> mask(80, 60);
        for (std::size_t p = 0; p < mask.size(); ++p)
            mask.pixels()[p] = image.label.pixels()[p] == kNotBody ? 0 : 1;
        BodyDepth body;
        body.set(std::as_const(image.depth_mm).view(), std::as_const(mask).view(), 1, 80);
        PartLabels labels;
        labeller.label(body, labels);
        for (std::size_t p = 0; p < labels.label.size(); ++p, ++at) {
            const TrainingSample& s = set.samples()[at];
            ASSERT_EQ(s.image, i);
            std::size_t node = 0;
            while (!nodes[node].is_leaf()) {
                const bool right = feature_response(set.images()[i], s.xy, s.scale,
                                                    nodes[node].feature) > nodes[node].threshold_mm;
                node = static_cast<std::size_t>(nodes[node].child) + (right ? 1 : 0);
            }
            ASSERT_EQ(labels.leaf[0][p], nodes[node].leaf);
        }
    }
    EXPECT_EQ(at, set.samples().size());
}

}  // namespace
}  // namespace kino
