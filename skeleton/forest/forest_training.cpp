#include "skeleton/forest/forest_training.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "base/check.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/forest/split_search.h"
#include "skeleton/forest/training_set.h"
#include "skeleton/forest/tree_pruning.h"

namespace kino {
namespace {

using Counts = std::vector<std::uint64_t>;

/// A node that may still be split, and where its samples lie.
struct Open {
    std::int32_t node = 0;
    std::uint64_t path = 1;
    std::size_t first = 0, last = 0;
};

/// Of a node, once its split is known.
struct Parted {
    BestSplit split;
    std::size_t middle = 0;  // first sample of the right child
    Counts left, right;
};

// Nodes with more samples than this share out their features among the threads.
constexpr std::size_t kSharedSamples = 30000;

class TreeTrainer {
  public:
    TreeTrainer(const TrainingImages& images, const ForestTraining& training, int tree)
        : images_(images), training_(training), tree_(tree), labels_(images.labels().size()) {
        count_ = training.images_per_tree > 0 ? training.images_per_tree : images.count();
        first_ = training.images_per_tree > 0 ? count_ * tree % images.count() : 0;
    }

    Result<void> grow(Forest& forest) {
        KINO_TRY(set_.load(images_, first_, count_, draw(false), training_.threads));
        nodes_.assign(1, {});
        counts_.assign(1, Counts(labels_));
        for (const TrainingSample& s : set_.samples()) ++counts_[0][s.label];
        samples_ = set_.samples().size();
        std::vector<Open> open{{0, 1, 0, set_.samples().size()}};
        for (level_ = 0; level_ < training_.depth && !open.empty(); ++level_) {
            const std::vector<Open> next = split_level(open);
            report(open.size());
            open = next;
        }
        set_ = {};
        if (training_.max_leaves > 0) prune_tree(nodes_, counts_, training_.max_leaves);
        level_ = -1;
        if (training_.leaf_pixels_per_image > 0) {
            KINO_TRY(refill_leaves());
            report(0);
        }
        store(forest);
        return {};
    }

  private:
    // Draws of growing and of filling differ; so do those of the trees.
    [[nodiscard]] SampleDraw draw(bool filling) const {
        const auto stream = 2 * static_cast<std::uint64_t>(tree_) + (filling ? 1 : 0);
        if (filling)
            return {training_.seed, stream, training_.leaf_pixels_per_image,
                    training_.leaf_balanced_share};
        return {training_.seed, stream, training_.pixels_per_image, training_.balanced_share};
    }

    [[nodiscard]] SplitSpace space() const {
        const bool deep = training_.deep_features > 0 && level_ >= training_.deep_level;
        return {deep ? training_.deep_features : training_.features, training_.thresholds,
                static_cast<int>(labels_), training_.reach_mm, training_.threshold_range_mm};
    }

    std::vector<Open> split_level(const std::vector<Open>& open) {
        std::vector<Parted> parted(open.size());
        std::vector<std::size_t> small;
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (open[i].last - open[i].first <= kSharedSamples)
                small.push_back(i);
            else
                part(open[i], training_.threads, parted[i]);
        }
        parallel_for(training_.threads, small.size(),
                     [&](std::size_t i) { part(open[small[i]], 1, parted[small[i]]); });
        std::vector<Open> next;
        for (std::size_t i = 0; i < open.size(); ++i) apply(open[i], parted[i], next);
        return next;
    }

    void part(const Open& open, int threads, Parted& out) {
        const SplitCandidates candidates =
            draw_candidates(space(), training_.seed, static_cast<std::uint64_t>(tree_), open.path);
        const auto features = static_cast<int>(candidates.features.size());
        TrainingSample* const all = set_.samples().data();
        const std::size_t stride =
            (open.last - open.first + training_.node_samples - 1) / training_.node_samples;
        const NodeSamples samples{all + open.first, all + open.last,
                                  static_cast<std::ptrdiff_t>(stride)};
        threads = std::min(threads, features);
        std::vector<BestSplit> best(static_cast<std::size_t>(threads));
        parallel_for(threads, best.size(), [&](std::size_t t) {
            thread_local SplitSearch search;
            const int share = static_cast<int>(t);
            best[t] = search.best(candidates, static_cast<int>(labels_), samples, set_.images(),
                                  features * share / threads, features * (share + 1) / threads);
        });
        for (BestSplit& b : best)
            if (b.gain_bits > out.split.gain_bits) out.split = std::move(b);
        if (out.split.gain_bits < training_.min_gain_bits || out.split.candidate < 0) {
            out.split.candidate = -1;
            return;
        }
        out.left.assign(labels_, 0);
        out.right.assign(labels_, 0);
        thread_local std::vector<TrainingSample> right;
        right.clear();
        TrainingSample* to = all + open.first;
        for (const TrainingSample* s = to; s < all + open.last; ++s) {
            const std::int32_t response =
                feature_response(set_.images()[s->image], s->xy, s->scale, out.split.feature);
            if (response > out.split.threshold_mm) {
                ++out.right[s->label];
                right.push_back(*s);
            } else {
                ++out.left[s->label];
                *to++ = *s;
            }
        }
        out.middle = static_cast<std::size_t>(to - all);
        std::copy(right.begin(), right.end(), to);
    }

    void apply(const Open& open, const Parted& parted, std::vector<Open>& next) {
        if (parted.split.candidate < 0) return;
        const auto child = static_cast<std::int32_t>(nodes_.size());
        ForestNode& node = nodes_[static_cast<std::size_t>(open.node)];
        node.feature = parted.split.feature;
        node.threshold_mm = parted.split.threshold_mm;
        node.child = child;
        for (int side = 0; side < 2; ++side) {
            const Counts& counts = side == 0 ? parted.left : parted.right;
            nodes_.emplace_back();
            counts_.push_back(counts);
            const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
            const bool pure = std::find(counts.begin(), counts.end(), total) != counts.end();
            if (!pure && total >= training_.min_samples)
                next.push_back({child + side, 2 * open.path + static_cast<std::uint64_t>(side),
                                side == 0 ? open.first : parted.middle,
                                side == 0 ? parted.middle : open.last});
        }
    }

    // A leaf that no pixel reaches keeps what it grew from.
    Result<void> refill_leaves() {
        // Leaves name themselves, in the order in which breadth_first() will put them.
        std::vector<ForestNode> named = nodes_;
        for (std::size_t i = 0; i < named.size(); ++i)
            if (named[i].is_leaf()) named[i].leaf = static_cast<std::int32_t>(i);
        const auto walkable = walk_nodes(breadth_first(named, 0));
        std::vector<std::uint32_t> filled(nodes_.size() * labels_, 0);
        std::vector<std::optional<Error>> errors(static_cast<std::size_t>(count_));
        std::mutex mutex;
        samples_ = 0;
        parallel_for(training_.threads, errors.size(), [&](std::size_t i) {
            thread_local TrainingImage picture;
            thread_local DrawnPixels pixels;
            thread_local std::vector<std::int32_t> leaf;
            const auto index = (first_ + static_cast<std::int64_t>(i)) % images_.count();
            if (auto done = draw_pixels(images_, index, draw(true), picture, pixels); !done) {
                errors[i] = done.error();
                return;
            }
            leaf.resize(pixels.xy.size());
            if (leaf.empty()) return;
            forest::functions().walk(walkable.data(), pixels.body.image(),
                                     {pixels.xy.data(), pixels.scale.data(), pixels.xy.size()},
                                     leaf.data());
            const std::lock_guard lock(mutex);
            samples_ += leaf.size();
            for (std::size_t p = 0; p < leaf.size(); ++p)
                ++filled[static_cast<std::size_t>(leaf[p]) * labels_ + pixels.label[p]];
        });
        for (const auto& error : errors)
            if (error) return tl::unexpected<Error>(*error);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const auto row = std::span(filled).subspan(i * labels_, labels_);
            if (std::any_of(row.begin(), row.end(), [](std::uint32_t n) { return n > 0; }))
                counts_[i].assign(row.begin(), row.end());
        }
        return {};
    }

    void store(Forest& forest) {
        std::unordered_map<std::string, std::int32_t> known;
        for (std::size_t d = 0; d < forest.distributions.size(); ++d)
            known.emplace(key(forest.distributions[d]), static_cast<std::int32_t>(d));
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i].is_leaf()) nodes_[i].leaf = static_cast<std::int32_t>(i);
        // What pruning cut off has no place in the tree.
        ForestTree tree = breadth_first(nodes_, 0);
        for (ForestNode& node : tree.nodes) {
            if (!node.is_leaf()) continue;
            const LabelDistribution row = votes(counts_[static_cast<std::size_t>(node.leaf)]);
            const auto [at, fresh] =
                known.emplace(key(row), static_cast<std::int32_t>(forest.distributions.size()));
            if (fresh) forest.distributions.push_back(row);
            node.leaf = at->second;
        }
        forest.trees.push_back(std::move(tree));
    }

    [[nodiscard]] LabelDistribution votes(Counts counts) const {
        const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
        const std::uint64_t most = *std::max_element(counts.begin(), counts.end());
        for (std::uint64_t& c : counts)
            if (c < most &&
                c * kForestVotes < static_cast<std::uint64_t>(training_.min_votes) * total)
                c = 0;
        return quantized_distribution(counts.data(), static_cast<int>(labels_));
    }

    static std::string key(const LabelDistribution& row) { return {row.begin(), row.end()}; }

    void report(std::size_t open) const {
        if (training_.progress) training_.progress({tree_, level_, open, nodes_.size(), samples_});
    }

    const TrainingImages& images_;
    const ForestTraining& training_;
    int tree_;
    std::size_t labels_;
    std::int64_t first_ = 0, count_ = 0;
    int level_ = 0;
    std::uint64_t samples_ = 0;
    std::vector<ForestNode> nodes_;
    std::vector<Counts> counts_;  // of the labels, per node
    TrainingSet set_;
};

}  // namespace

std::string training_defect(const ForestTraining& t) {
    if (t.trees < 1 || t.trees > kForestMaxTrees) return "trees must be 1 to 16";
    if (t.depth < 1 || t.depth > kForestMaxDepth) return "depth must be 1 to 24";
    if (t.threads < 1 || t.threads > 256) return "threads must be 1 to 256";
    if (t.pixels_per_image < 1 || t.leaf_pixels_per_image < 0) return "too few pixels per image";
    if (!(t.balanced_share >= 0 && t.balanced_share <= 1)) return "balanced share is not in 0..1";
    if (t.images_per_tree < 0) return "images per tree must not be negative";
    if (t.features < 1 || t.features > 100000) return "features must be 1 to 100000";
    if (t.thresholds < 1 || t.thresholds > 64) return "thresholds must be 1 to 64";
    if (!(t.reach_mm > 0 && t.reach_mm <= 8000)) return "reach must be up to 8000 mm";
    if (!(t.threshold_range_mm >= 0 && t.threshold_range_mm <= 10000))
        return "threshold range must be up to 10000 mm";
    if (!(t.leaf_balanced_share >= 0 && t.leaf_balanced_share <= 1))
        return "balanced share of the leaves is not in 0..1";
    if (t.deep_features < 0 || t.deep_features > 100000) return "deep features must be 0 to 100000";
    if (t.min_votes < 0 || t.min_votes > kForestVotes) return "least votes must be 0 to 255";
    if (t.node_samples < 1) return "a node needs samples to be split by";
    if (t.note.size() > 65535) return "the note is too long";
    return {};
}

Result<Forest> train_forest(const TrainingImages& images, const ForestTraining& training) {
    if (const std::string defect = training_defect(training); !defect.empty())
        return fail("cannot train: " + defect);
    if (images.count() < 1) return fail("there are no pictures to train on");
    Forest forest;
    forest.labels = images.labels();
    forest.note = training.note;
    if (forest.labels.empty() || forest.labels.size() > kForestMaxLabels)
        return fail("cannot train: there must be 1 to 32 labels");
    for (int t = 0; t < training.trees; ++t)
        KINO_TRY(TreeTrainer(images, training, t).grow(forest));
    if (const std::string defect = forest_defect(forest); !defect.empty())
        return fail("training gave no sound forest: " + defect, {},
                    "is there a body in the pictures?");
    return forest;
}

}  // namespace kino
