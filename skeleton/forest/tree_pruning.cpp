#include "skeleton/forest/tree_pruning.h"

#include <numeric>
#include <queue>
#include <utility>

#include "base/check.h"
#include "skeleton/forest/split_search.h"

namespace kino {
namespace {

// Samples times their entropy.
double uncertainty(const std::vector<std::uint64_t>& counts) {
    const std::uint64_t n = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    return information({&n, 1}) - information(counts);
}

}  // namespace

void prune_tree(std::vector<ForestNode>& nodes,
                const std::vector<std::vector<std::uint64_t>>& counts, std::size_t max_leaves) {
    KINO_CHECK(max_leaves > 0 && counts.size() == nodes.size());
    std::vector<std::int32_t> parent(nodes.size(), -1);
    std::size_t leaves = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].is_leaf()) {
            ++leaves;
            continue;
        }
        const auto child = static_cast<std::size_t>(nodes[i].child);
        parent[child] = parent[child + 1] = static_cast<std::int32_t>(i);
    }
    // Least loss on top; of equal ones the later node.
    using Entry = std::pair<double, std::int32_t>;
    std::priority_queue<Entry> queue;
    const auto offer = [&](std::int32_t node) {
        if (node < 0) return;
        const auto child = static_cast<std::size_t>(nodes[static_cast<std::size_t>(node)].child);
        if (!nodes[child].is_leaf() || !nodes[child + 1].is_leaf()) return;
        const double loss = uncertainty(counts[static_cast<std::size_t>(node)]) -
                            uncertainty(counts[child]) - uncertainty(counts[child + 1]);
        queue.emplace(-loss, node);
    };
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!nodes[i].is_leaf()) offer(static_cast<std::int32_t>(i));
    while (leaves > max_leaves && !queue.empty()) {
        const std::int32_t node = queue.top().second;
        queue.pop();
        nodes[static_cast<std::size_t>(node)] = ForestNode{};
        --leaves;
        offer(parent[static_cast<std::size_t>(node)]);
    }
}

Forest shallower(const Forest& forest, int depth) {
    KINO_CHECK(depth >= 0 && forest_defect(forest).empty());
    const int labels = static_cast<int>(forest.labels.size());
    Forest out = forest;
    for (ForestTree& tree : out.trees) {
        // Children come after their parents.
        std::vector<int> level(tree.nodes.size(), 0);
        for (std::size_t i = 0; i < level.size(); ++i)
            if (const ForestNode& n = tree.nodes[i]; !n.is_leaf())
                level[static_cast<std::size_t>(n.child)] =
                    level[static_cast<std::size_t>(n.child) + 1] = level[i] + 1;
        // Votes of each node in 2^-kForestMaxDepth.
        std::vector<std::vector<std::uint64_t>> votes(tree.nodes.size());
        for (std::size_t i = votes.size(); i-- > 0;) {
            ForestNode& n = tree.nodes[i];
            if (level[i] < depth) continue;
            std::vector<std::uint64_t>& sum = votes[i];
            sum.assign(static_cast<std::size_t>(labels), 0);
            if (n.is_leaf()) {
                const auto& row = out.distributions[static_cast<std::size_t>(n.leaf)];
                for (std::size_t l = 0; l < sum.size(); ++l)
                    sum[l] = static_cast<std::uint64_t>(row[l]) << kForestMaxDepth;
                continue;
            }
            for (const std::int32_t child : {n.child, n.child + 1})
                for (std::size_t l = 0; l < sum.size(); ++l)
                    sum[l] += votes[static_cast<std::size_t>(child)][l] / 2;
            if (level[i] > depth) continue;
            n = ForestNode{};
            n.leaf = static_cast<std::int32_t>(out.distributions.size());
            out.distributions.push_back(quantized_distribution(sum.data(), labels));
        }
        tree = breadth_first(tree.nodes, 0);
    }
    std::vector<std::int32_t> place(out.distributions.size(), -1);
    std::vector<LabelDistribution> used;
    for (ForestTree& tree : out.trees)
        for (ForestNode& n : tree.nodes) {
            if (!n.is_leaf()) continue;
            std::int32_t& to = place[static_cast<std::size_t>(n.leaf)];
            if (to < 0) {
                to = static_cast<std::int32_t>(used.size());
                used.push_back(out.distributions[static_cast<std::size_t>(n.leaf)]);
            }
            n.leaf = to;
        }
    out.distributions = std::move(used);
    return out;
}

}  // namespace kino
