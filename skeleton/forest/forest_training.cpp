#include "skeleton/forest/forest_training.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "base/check.h"
#include "skeleton/forest/split_search.h"
#include "skeleton/forest/training_block.h"

namespace kino {
namespace {

using Counts = std::vector<std::uint64_t>;

/// A node that may still be split.
struct Open {
    std::int32_t node = 0;
    std::uint64_t path = 1;
};

class TreeTrainer {
  public:
    TreeTrainer(const TrainingImages& images, const ForestTraining& training, int tree)
        : images_(images),
          training_(training),
          tree_(tree),
          labels_(images.labels().size()),
          space_{training.features, training.thresholds, static_cast<int>(labels_),
                 training.reach_mm, training.threshold_range_mm} {
        count_ = training.images_per_tree > 0 ? training.images_per_tree : images.count();
        first_ = training.images_per_tree > 0 ? count_ * tree % images.count() : 0;
    }

    /// Leaves hold their own index among the leaves' distributions, which are added to `forest`.
    Result<void> grow(Forest& forest) {
        nodes_.assign(1, {});
        counts_.assign(1, Counts(labels_));
        std::vector<Open> open{{}};
        for (level_ = 0; level_ < training_.depth && !open.empty(); ++level_) {
            std::vector<Open> next;
            const std::size_t batch = std::max<std::size_t>(
                1, training_.histogram_bytes / SplitSearch::bytes_per_node(space_));
            for (std::size_t at = 0; at < open.size(); at += batch) {
                const std::size_t size = std::min(batch, open.size() - at);
                KINO_TRY(split_batch({open.data() + at, size}, next));
                report(at + size);
            }
            open = std::move(next);
        }
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
        if (filling) return {training_.seed, stream, training_.leaf_pixels_per_image, 0};
        return {training_.seed, stream, training_.pixels_per_image, training_.balanced_share};
    }

    template <class PerBlock>
    Result<void> pass(bool filling, const PerBlock& per_block) {
        samples_ = 0;
        TrainingBlock block;
        for (std::int64_t at = 0; at < count_; at += training_.block_images) {
            const auto size =
                static_cast<int>(std::min<std::int64_t>(training_.block_images, count_ - at));
            KINO_TRY(block.load(images_, first_ + at, size, draw(filling), training_.threads));
            block.walk(nodes_, training_.threads);
            for (const auto& list : block.samples()) samples_ += list.size();
            per_block(block);
        }
        return {};
    }

    Result<void> split_batch(std::span<const Open> batch, std::vector<Open>& next) {
        std::vector<std::int32_t> slot_of(nodes_.size(), -1);
        std::vector<SplitCandidates> candidates(batch.size());
        parallel_for(training_.threads, batch.size(), [&](std::size_t s) {
            candidates[s] = draw_candidates(space_, training_.seed,
                                            static_cast<std::uint64_t>(tree_), batch[s].path);
        });
        for (std::size_t s = 0; s < batch.size(); ++s)
            slot_of[static_cast<std::size_t>(batch[s].node)] = static_cast<std::int32_t>(s);
        SplitSearch search(space_, std::move(candidates));
        KINO_TRY(pass(false, [&](TrainingBlock& block) { count(block, slot_of, search); }));
        std::vector<BestSplit> best(batch.size());
        parallel_for(training_.threads, batch.size(),
                     [&](std::size_t s) { best[s] = search.best(s); });
        for (std::size_t s = 0; s < batch.size(); ++s) {
            if (batch[s].node == 0) counts_[0] = search.totals(s);
            apply(batch[s], best[s], next);
        }
        return {};
    }

    // Threads share the work by features, so that no two write the same counts.
    void count(TrainingBlock& block, const std::vector<std::int32_t>& slot_of,
               SplitSearch& search) {
        sorted_.clear();
        for (const auto& list : block.samples())
            for (const TrainingSample& s : list)
                if (slot_of[static_cast<std::size_t>(s.node)] >= 0) sorted_.push_back(s);
        std::stable_sort(sorted_.begin(), sorted_.end(),
                         [](const auto& a, const auto& b) { return a.node < b.node; });
        const int threads = std::min(training_.threads, training_.features);
        parallel_for(threads, static_cast<std::size_t>(threads), [&](std::size_t t) {
            const int share = static_cast<int>(t);
            const int first = training_.features * share / threads;
            const int last = training_.features * (share + 1) / threads;
            for (std::size_t at = 0; at < sorted_.size();) {
                std::size_t end = at;
                while (end < sorted_.size() && sorted_[end].node == sorted_[at].node) ++end;
                const std::int32_t slot = slot_of[static_cast<std::size_t>(sorted_[at].node)];
                search.count(static_cast<std::size_t>(slot), {sorted_.data() + at, end - at}, block,
                             first, last);
                at = end;
            }
        });
    }

    void apply(const Open& open, const BestSplit& best, std::vector<Open>& next) {
        if (best.gain_bits < training_.min_gain_bits || best.left.empty()) return;
        const auto child = static_cast<std::int32_t>(nodes_.size());
        ForestNode& node = nodes_[static_cast<std::size_t>(open.node)];
        node.feature = best.feature;
        node.threshold_mm = best.threshold_mm;
        node.child = child;
        for (int side = 0; side < 2; ++side) {
            const Counts& counts = side == 0 ? best.left : best.right;
            nodes_.emplace_back();
            counts_.push_back(counts);
            const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
            const bool pure = std::find(counts.begin(), counts.end(), total) != counts.end();
            if (!pure && total >= training_.min_samples)
                next.push_back({child + side, 2 * open.path + static_cast<std::uint64_t>(side)});
        }
    }

    // A leaf that no pixel reaches keeps what it grew from.
    Result<void> refill_leaves() {
        std::vector<Counts> filled(nodes_.size());
        KINO_TRY(pass(true, [&](TrainingBlock& block) {
            for (const auto& list : block.samples())
                for (const TrainingSample& s : list) {
                    Counts& counts = filled[static_cast<std::size_t>(s.node)];
                    counts.resize(labels_);
                    ++counts[s.label];
                }
        }));
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            if (!filled[i].empty()) counts_[i] = std::move(filled[i]);
        return {};
    }

    void store(Forest& forest) {
        std::unordered_map<std::string, std::int32_t> known;
        for (std::size_t d = 0; d < forest.distributions.size(); ++d)
            known.emplace(key(forest.distributions[d]), static_cast<std::int32_t>(d));
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (!nodes_[i].is_leaf()) continue;
            const LabelDistribution row =
                quantized_distribution(counts_[i].data(), static_cast<int>(labels_));
            const auto [at, fresh] =
                known.emplace(key(row), static_cast<std::int32_t>(forest.distributions.size()));
            if (fresh) forest.distributions.push_back(row);
            nodes_[i].leaf = at->second;
        }
        forest.trees.push_back(breadth_first(nodes_, 0));
    }

    static std::string key(const LabelDistribution& row) { return {row.begin(), row.end()}; }

    void report(std::size_t open) const {
        if (training_.progress) training_.progress({tree_, level_, open, nodes_.size(), samples_});
    }

    const TrainingImages& images_;
    const ForestTraining& training_;
    int tree_;
    std::size_t labels_;
    SplitSpace space_;
    std::int64_t first_ = 0, count_ = 0;
    int level_ = 0;
    std::uint64_t samples_ = 0;
    std::vector<ForestNode> nodes_;
    std::vector<Counts> counts_;  // of the labels, per node
    std::vector<TrainingSample> sorted_;
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
    if (t.block_images < 1 || t.block_images > 4096) return "block must be 1 to 4096 images";
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
