#include "viz/quality/governor/level_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/check.h"

namespace kino {
namespace {

constexpr std::size_t kMostSums = 4096;

/// A sum over the first parts, and how it came about.
struct PartialSum {
    Level sum;
    std::uint32_t before = 0;  ///< index into the sums of one part less
    std::uint32_t level = 0;
};

bool usable(const Level& level) {
    return std::isfinite(level.cost_ms) && std::isfinite(level.error);
}

/// Keeps what nothing else beats in cost and error both, in ascending cost.
void keep_best(std::vector<PartialSum>& sums) {
    std::sort(sums.begin(), sums.end(), [](const PartialSum& a, const PartialSum& b) {
        if (a.sum.cost_ms != b.sum.cost_ms) return a.sum.cost_ms < b.sum.cost_ms;
        return a.sum.error < b.sum.error;
    });
    std::size_t kept = 0;
    for (const PartialSum& sum : sums) {
        if (kept > 0 && !(sum.sum.error < sums[kept - 1].sum.error)) continue;
        sums[kept++] = sum;
    }
    sums.resize(kept);
    if (kept <= kMostSums) return;
    for (std::size_t i = 0; i < kMostSums; ++i) sums[i] = sums[i * (kept - 1) / (kMostSums - 1)];
    sums.resize(kMostSums);
}

}  // namespace

std::vector<std::size_t> choose_levels(std::span<const std::vector<Level>> parts,
                                       double budget_ms) {
    std::vector<std::vector<PartialSum>> front(1, {PartialSum{}});
    for (const std::vector<Level>& levels : parts) {
        KINO_CHECK(!levels.empty());
        const bool any = std::any_of(levels.begin(), levels.end(), usable);
        std::vector<PartialSum> sums;
        for (std::uint32_t before = 0; before < front.back().size(); ++before) {
            const Level& so_far = front.back()[before].sum;
            for (std::uint32_t level = 0; level < levels.size(); ++level) {
                if (any && !usable(levels[level])) continue;
                const Level value = any ? levels[level] : Level{};
                sums.push_back(
                    {{so_far.cost_ms + value.cost_ms, so_far.error + value.error}, before, level});
                if (!any) break;
            }
        }
        keep_best(sums);
        front.push_back(std::move(sums));
    }
    // Ascending cost is descending error: the last one that fits is the best.
    const std::vector<PartialSum>& last = front.back();
    std::size_t best = 0;
    for (std::size_t i = 0; i < last.size(); ++i) {
        if (last[i].sum.cost_ms <= budget_ms) best = i;
    }
    std::vector<std::size_t> choice(parts.size());
    for (std::size_t part = parts.size(); part > 0; --part) {
        choice[part - 1] = front[part][best].level;
        best = front[part][best].before;
    }
    return choice;
}

Level sum_of(std::span<const std::vector<Level>> parts, std::span<const std::size_t> choice) {
    KINO_CHECK_EQ(parts.size(), choice.size());
    Level sum;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        sum.cost_ms += parts[i].at(choice[i]).cost_ms;
        sum.error += parts[i].at(choice[i]).error;
    }
    return sum;
}

}  // namespace kino
