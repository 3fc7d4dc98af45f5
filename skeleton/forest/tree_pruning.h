#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "skeleton/forest/forest.h"

namespace kino {

/// Turns splits into leaves, those first whose loss of information about the labels (in bits, over
/// all samples that reach them) is least, until at most `max_leaves` (> 0) are left. `counts` are
/// the samples of each label at every node, a split's those of its children together. Of equal
/// losses the later node goes first.
void prune_tree(std::vector<ForestNode>& nodes,
                const std::vector<std::vector<std::uint64_t>>& counts, std::size_t max_leaves);

/// The forest cut off below `depth` >= 0 levels of splits. A leaf in the place of a subtree votes
/// as the mean of its leaves, each counted half as much a level further down: how often they were
/// reached is not kept in a forest. Distributions that no leaf names are left out.
[[nodiscard]] Forest shallower(const Forest& forest, int depth);

}  // namespace kino
