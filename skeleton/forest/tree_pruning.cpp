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

}  // namespace kino
