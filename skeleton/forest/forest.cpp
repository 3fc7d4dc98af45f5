#include "skeleton/forest/forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/check.h"

namespace kino {
namespace {

std::string tree_defect(const ForestTree& tree, std::size_t distributions) {
    const auto& nodes = tree.nodes;
    if (nodes.empty()) return "has no nodes";
    std::size_t splits = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const ForestNode& n = nodes[i];
        if (n.is_leaf()) {
            if (n.leaf < 0 || static_cast<std::size_t>(n.leaf) >= distributions)
                return fmt::format("leaf {} has no distribution", i);
            continue;
        }
        const std::size_t child = 2 * splits++ + 1;
        if (static_cast<std::size_t>(n.child) != child || child <= i)
            return fmt::format("node {} is out of order", i);
    }
    if (nodes.size() != 2 * splits + 1) return "has nodes that no split leads to";
    return tree_depth(tree) > kForestMaxDepth ? "is too deep" : "";
}

bool sound_name(const std::string& name) {
    return !name.empty() && name.size() < 32 &&
           std::all_of(name.begin(), name.end(), [](char c) { return c > 32 && c < 127; });
}

}  // namespace

int tree_depth(const ForestTree& tree) {
    std::vector<int> depth(tree.nodes.size(), 0);
    int deepest = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (tree.nodes[i].is_leaf()) continue;
        const auto child = static_cast<std::size_t>(tree.nodes[i].child);
        if (child + 1 >= depth.size()) continue;
        depth[child] = depth[child + 1] = depth[i] + 1;
        deepest = std::max(deepest, depth[i] + 1);
    }
    return deepest;
}

std::string forest_defect(const Forest& forest) {
    if (forest.labels.empty() || forest.labels.size() > kForestMaxLabels)
        return fmt::format("{} labels", forest.labels.size());
    if (!std::all_of(forest.labels.begin(), forest.labels.end(), sound_name))
        return "a label has an unusable name";
    if (forest.note.size() > 65535) return "the note is too long";
    if (forest.trees.empty() || forest.trees.size() > kForestMaxTrees)
        return fmt::format("{} trees", forest.trees.size());
    for (std::size_t d = 0; d < forest.distributions.size(); ++d) {
        const LabelDistribution& row = forest.distributions[d];
        const auto named = row.begin() + static_cast<std::ptrdiff_t>(forest.labels.size());
        if (std::accumulate(row.begin(), named, 0) != kForestVotes ||
            std::any_of(named, row.end(), [](std::uint8_t v) { return v != 0; }))
            return fmt::format("distribution {} does not add up", d);
    }
    for (std::size_t t = 0; t < forest.trees.size(); ++t) {
        const std::string defect = tree_defect(forest.trees[t], forest.distributions.size());
        if (!defect.empty()) return fmt::format("tree {} {}", t, defect);
    }
    return {};
}

ForestTree breadth_first(const std::vector<ForestNode>& nodes, std::int32_t root) {
    ForestTree tree;
    std::vector<std::int32_t> queue{root};
    for (std::size_t i = 0; i < queue.size(); ++i) {
        ForestNode node = nodes.at(static_cast<std::size_t>(queue[i]));
        if (!node.is_leaf()) {
            const std::int32_t child = node.child;
            node.child = static_cast<std::int32_t>(queue.size());
            node.leaf = -1;
            queue.push_back(child);
            queue.push_back(child + 1);
            KINO_CHECK_LE(queue.size(), 2 * nodes.size());
        }
        tree.nodes.push_back(node);
    }
    return tree;
}

LabelDistribution quantized_distribution(const std::uint64_t* counts, int count) {
    KINO_CHECK_LE(count, kForestMaxLabels);
    LabelDistribution out{};
    const std::uint64_t total = std::accumulate(counts, counts + count, std::uint64_t{0});
    if (total == 0) return out;
    KINO_CHECK_LT(total, std::uint64_t{1} << 55);
    std::array<std::uint64_t, kForestMaxLabels> remainder{};
    int given = 0;
    for (int l = 0; l < count; ++l) {
        const auto i = static_cast<std::size_t>(l);
        const std::uint64_t scaled = counts[l] * kForestVotes;
        out[i] = static_cast<std::uint8_t>(scaled / total);
        remainder[i] = scaled % total;
        given += out[i];
    }
    for (; given < kForestVotes; ++given) {
        const auto most = std::max_element(remainder.begin(), remainder.begin() + count);
        *most = 0;
        ++out[static_cast<std::size_t>(most - remainder.begin())];
    }
    return out;
}

}  // namespace kino
