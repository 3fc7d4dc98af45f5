#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "skeleton/forest/forest.h"
#include "skeleton/forest/training_set.h"

namespace kino {

/// Which features and thresholds a node may choose from.
struct SplitCandidates {
    std::vector<ForestFeature> features;      ///< the first half compares with the pixel itself
    std::vector<std::int16_t> thresholds_mm;  ///< of all features, rising
};

struct SplitSpace {
    int features = 0, thresholds = 0, labels = 0;
    double reach_mm = 0, threshold_range_mm = 0;
};

/// A node's candidates, drawn from the seed, the tree and the node's path (1 for the root, 2 p and
/// 2 p + 1 for the children of p).
[[nodiscard]] SplitCandidates draw_candidates(const SplitSpace& space, std::uint64_t seed,
                                              std::uint64_t tree, std::uint64_t path);

struct BestSplit {
    double gain_bits = 0;  ///< 0: no candidate parts the samples
    int candidate = -1;    ///< index of the feature
    ForestFeature feature;
    std::int16_t threshold_mm = 0;
    std::vector<std::uint64_t> left, right;  ///< samples of each label
};

/// Sum of c log2 c; gains are differences of such sums.
[[nodiscard]] double information(std::span<const std::uint64_t> counts);

/// The samples that a node's split is chosen by: every `stride`-th of [first, last).
struct NodeSamples {
    const TrainingSample* first = nullptr;
    const TrainingSample* last = nullptr;
    std::ptrdiff_t stride = 1;
};

/// The first of the features [first, last) with the largest gain of information over the node's
/// samples. Keeps its memory; one thread at a time.
class SplitSearch {
  public:
    SplitSearch() : SplitSearch(forest::functions()) {}
    explicit SplitSearch(const forest::Functions& functions) : functions_(&functions) {}

    [[nodiscard]] BestSplit best(const SplitCandidates& candidates, int labels,
                                 const NodeSamples& samples,
                                 std::span<const forest::WalkImage> images, int first, int last);

  private:
    struct Chunk {
        int first = 0, last = 0;
        int singles = 0;   // of them, at the front
        int pairs_at = 0;  // where the others' responses begin
    };
    void prepare(const SplitCandidates& candidates, int labels, const NodeSamples& samples);
    void count(const SplitCandidates& candidates, const Chunk& chunk, const NodeSamples& samples,
               std::span<const forest::WalkImage> images);
    void judge(const SplitCandidates& candidates, const Chunk& chunk, BestSplit& best);

    const forest::Functions* functions_;
    std::int32_t low_ = 0, high_ = 0;
    std::vector<std::uint8_t> bin_of_;    // by response - low_
    std::vector<std::uint64_t> totals_;   // by label
    std::vector<int> present_, slot_of_;  // labels with samples, and their places among them
    std::vector<std::uint32_t> counts_;   // by slot, feature of the chunk, bin
    std::vector<std::uint32_t> u_, v_;
    std::vector<std::int32_t> responses_;
    std::vector<double> left_, right_;
    std::vector<std::uint64_t> left_samples_;
    std::size_t bins_ = 0;
    std::uint64_t samples_ = 0;
    double whole_ = 0, best_gain_ = 0;
};

}  // namespace kino
