#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "skeleton/forest/forest_kernel.h"

namespace kino {

/// Offsets of features are counted in quarters of a millimetre at the body, so that they fit 16
/// bits and lose less than 0.02 px by rounding.
constexpr int kForestOffsetsPerMm = 4;
/// Depth of everything that is not the body, mm; beyond any reading and any threshold.
constexpr std::int16_t kForestBackgroundMm = 32767;
constexpr int kForestMaxLabels = 32;
constexpr int kForestMaxTrees = 16;
constexpr int kForestMaxDepth = 24;
/// A leaf's distribution sums to this.
constexpr int kForestVotes = 255;

/// How often each label was seen, in 255ths.
using LabelDistribution = std::array<std::uint8_t, kForestMaxLabels>;

/// The feature of Shotton et al., "Real-Time Human Pose Recognition in Parts from Single Depth
/// Images" (CVPR 2011), eq. 1: depth at (pixel + u focal / depth) minus depth at (pixel + v focal /
/// depth), mm. The right branch is taken where it is greater than the threshold.
struct ForestFeature {
    std::array<std::int16_t, 2> u{}, v{};  ///< x right, y down; quarters of a millimetre
    friend bool operator==(const ForestFeature&, const ForestFeature&) = default;
};

/// Either a split or a leaf. `child` is the left child's index, the right one follows it; leaves
/// hold the index of a distribution in `leaf`.
struct ForestNode {
    ForestFeature feature;
    std::int16_t threshold_mm = 0;
    std::int32_t child = -1;  ///< -1: leaf
    std::int32_t leaf = -1;
    [[nodiscard]] bool is_leaf() const { return child < 0; }
    friend bool operator==(const ForestNode&, const ForestNode&) = default;
};

/// Nodes in breadth-first order: the children of the k-th split are nodes 2k + 1 and 2k + 2.
struct ForestTree {
    std::vector<ForestNode> nodes;
    friend bool operator==(const ForestTree&, const ForestTree&) = default;
};

/// What is trained, stored and loaded. PartLabeller makes it ready to run.
struct Forest {
    std::vector<std::string> labels;  ///< names, 1..31 printable ASCII characters each
    std::vector<LabelDistribution> distributions;
    std::vector<ForestTree> trees;
    std::string note;  ///< how it came to be: command, seed, licence; at most 65535 bytes

    friend bool operator==(const Forest&, const Forest&) = default;
};

/// Levels below the root of the deepest leaf; the tree must be sound.
[[nodiscard]] int tree_depth(const ForestTree& tree);

/// Empty if the forest keeps all promises above, else what is wrong with it.
[[nodiscard]] std::string forest_defect(const Forest& forest);

/// Nodes of any order into the breadth-first one; `root` and every child index must be sound.
[[nodiscard]] ForestTree breadth_first(const std::vector<ForestNode>& nodes, std::int32_t root);

/// Counts to 255ths by the largest remainder (ties to the lower label): sums to 255 unless all
/// counts are 0. `count` <= 32 labels.
[[nodiscard]] LabelDistribution quantized_distribution(const std::uint64_t* counts, int count);

}  // namespace kino
