#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "skeleton/forest/body_depth.h"
#include "skeleton/forest/forest.h"

namespace kino {

/// The labels of one body's listed pixels, in their order.
struct PartLabels {
    std::vector<std::uint8_t> label;   ///< the likeliest; the lowest of equally likely ones
    std::vector<std::uint16_t> votes;  ///< for it, of 255 per tree
    std::vector<std::vector<std::int32_t>> leaf;  ///< per tree: distribution index per pixel
};

/// A sound tree as the kernels walk it.
[[nodiscard]] std::vector<forest::WalkNode> walk_nodes(const ForestTree& tree);

/// A forest ready to run: trees vote with the mean of their leaves' distributions.
class PartLabeller {
  public:
    /// The forest must be sound (forest_defect() is empty). `functions` must stay alive.
    explicit PartLabeller(const Forest& forest,
                          const forest::Functions& functions = forest::functions());

    /// Replaces `out`, whose memory is reused. One labeller may serve several threads.
    void label(const BodyDepth& body, PartLabels& out) const;

    /// Mean over the trees of the share of each label at a labelled pixel, 0..1; `share` has
    /// label_count() elements.
    void shares(const PartLabels& labels, std::size_t pixel, std::span<float> share) const;

    [[nodiscard]] int label_count() const { return label_count_; }
    [[nodiscard]] int tree_count() const { return static_cast<int>(trees_.size()); }
    [[nodiscard]] std::size_t memory_bytes() const;

  private:
    int label_count_ = 0;
    int stride_ = 16;
    const forest::Functions* functions_;
    std::vector<std::vector<forest::WalkNode>> trees_;
    std::vector<std::uint8_t> distributions_;
};

}  // namespace kino
