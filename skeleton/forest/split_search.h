#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "skeleton/forest/forest.h"
#include "skeleton/forest/training_block.h"

namespace kino {

/// Which features and thresholds a node may choose from.
struct SplitCandidates {
    std::vector<ForestFeature> features;
    std::vector<std::int16_t> thresholds_mm;  ///< per feature so many, rising
};

struct SplitSpace {
    int features = 0, thresholds = 0, labels = 0;
    double reach_mm = 0, threshold_range_mm = 0;
};

/// A node's candidates, drawn from the seed, the tree and the node's path (1 for the root, 2 p and
/// 2 p + 1 for the children of p). Half of the features compare with the pixel itself.
[[nodiscard]] SplitCandidates draw_candidates(const SplitSpace& space, std::uint64_t seed,
                                              std::uint64_t tree, std::uint64_t path);

struct BestSplit {
    double gain_bits = 0;  ///< 0: no candidate parts the samples
    ForestFeature feature;
    std::int16_t threshold_mm = 0;
    std::vector<std::uint64_t> left, right;  ///< samples of each label
};

/// Sum of c log2 c; gains are differences of such sums.
[[nodiscard]] double information(std::span<const std::uint64_t> counts);

/// Counts the responses of the samples of a batch of nodes.
class SplitSearch {
  public:
    SplitSearch(const SplitSpace& space, std::vector<SplitCandidates> nodes);

    [[nodiscard]] static std::size_t bytes_per_node(const SplitSpace& space);

    /// `samples` are of one slot (the index into `nodes`); features [first, last). Calls for other
    /// slots or other features may run at the same time.
    void count(std::size_t slot, std::span<const TrainingSample> samples,
               const TrainingBlock& block, int first, int last);

    /// The first of the candidates with the largest gain of information.
    [[nodiscard]] BestSplit best(std::size_t slot) const;
    /// Samples of each label that were counted.
    [[nodiscard]] std::vector<std::uint64_t> totals(std::size_t slot) const;

  private:
    [[nodiscard]] const std::uint32_t* bins(std::size_t slot, int feature) const;

    SplitSpace space_;
    std::vector<SplitCandidates> nodes_;
    std::size_t per_feature_;
    std::vector<std::uint32_t> counts_;  // by slot, feature, bin, label
};

}  // namespace kino
