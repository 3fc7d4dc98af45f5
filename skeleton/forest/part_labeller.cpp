#include "skeleton/forest/part_labeller.h"

#include "base/check.h"

namespace kino {
namespace {

// The root is at 0 and nothing at 1, so that siblings share 32 aligned bytes.
std::int32_t place(std::int32_t node) {
    return node == 0 ? 0 : node + 1;
}

}  // namespace

std::vector<forest::WalkNode> walk_nodes(const ForestTree& tree) {
    std::vector<forest::WalkNode> out(tree.nodes.size() + 1);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const ForestNode& n = tree.nodes[i];
        const std::int32_t here = place(static_cast<std::int32_t>(i));
        forest::WalkNode& w = out[static_cast<std::size_t>(here)];
        if (n.is_leaf())
            w = {static_cast<std::int16_t>(n.leaf & 0xFFFF),
                 static_cast<std::int16_t>(n.leaf >> 16),
                 0,
                 0,
                 kForestBackgroundMm,
                 here};
        else
            w = {n.feature.u[0], n.feature.u[1], n.feature.v[0],
                 n.feature.v[1], n.threshold_mm, place(n.child)};
    }
    return out;
}

PartLabeller::PartLabeller(const Forest& forest, const forest::Functions& functions)
    : label_count_(static_cast<int>(forest.labels.size())),
      stride_(label_count_ <= 16 ? 16 : 32),
      functions_(&functions) {
    KINO_CHECK(forest_defect(forest).empty());
    for (const ForestTree& tree : forest.trees) trees_.push_back(walk_nodes(tree));
    for (const LabelDistribution& row : forest.distributions)
        distributions_.insert(distributions_.end(), row.begin(), row.begin() + stride_);
}

void PartLabeller::label(const BodyDepth& body, PartLabels& out) const {
    const std::size_t count = body.count();
    out.label.resize(count);
    out.votes.resize(count);
    out.leaf.resize(trees_.size());
    if (count == 0) {
        for (auto& leaf : out.leaf) leaf.clear();
        return;
    }
    std::vector<const std::int32_t*> leaves;
    for (std::size_t t = 0; t < trees_.size(); ++t) {
        out.leaf[t].resize(count);
        functions_->walk(trees_[t].data(), body.image(), body.pixels(), out.leaf[t].data());
        leaves.push_back(out.leaf[t].data());
    }
    functions_->vote({leaves.data(), tree_count(), distributions_.data(), stride_}, count,
                     out.label.data(), out.votes.data());
}

void PartLabeller::shares(const PartLabels& labels, std::size_t pixel,
                          std::span<float> share) const {
    KINO_CHECK_EQ(share.size(), static_cast<std::size_t>(label_count_));
    KINO_CHECK_EQ(labels.leaf.size(), trees_.size());
    for (std::size_t l = 0; l < share.size(); ++l) {
        int sum = 0;
        for (const auto& leaf : labels.leaf)
            sum += distributions_[static_cast<std::size_t>(leaf.at(pixel)) *
                                      static_cast<std::size_t>(stride_) +
                                  l];
        share[l] = static_cast<float>(sum) / static_cast<float>(kForestVotes * tree_count());
    }
}

std::size_t PartLabeller::memory_bytes() const {
    std::size_t bytes = distributions_.size();
    for (const auto& tree : trees_) bytes += tree.size() * sizeof(forest::WalkNode);
    return bytes;
}

}  // namespace kino
