#include "viz/surface/mesh_ranges.h"

#include <algorithm>
#include <iterator>

#include "base/check.h"

namespace kino {

MeshRanges::MeshRanges(std::uint32_t capacity) : capacity_(capacity) {
    if (capacity > 0) gaps_[0] = capacity;
}

std::optional<std::uint32_t> MeshRanges::take(std::uint32_t count) {
    KINO_CHECK(count > 0);
    const auto gap =
        std::find_if(gaps_.begin(), gaps_.end(), [&](const auto& g) { return g.second >= count; });
    if (gap == gaps_.end()) return std::nullopt;
    const auto [first, length] = *gap;
    gaps_.erase(gap);
    if (length > count) gaps_[first + count] = length - count;
    used_ += count;
    return first;
}

void MeshRanges::give_back(std::uint32_t first, std::uint32_t count) {
    KINO_CHECK(count > 0 && count <= used_ && first <= capacity_ - count);
    const auto after = gaps_.lower_bound(first);
    KINO_CHECK(after == gaps_.end() || after->first >= first + count);
    std::uint32_t start = first;
    std::uint32_t length = count;
    if (after != gaps_.begin()) {
        const auto before = std::prev(after);
        KINO_CHECK(before->first + before->second <= first);
        if (before->first + before->second == first) {
            start = before->first;
            length += before->second;
            gaps_.erase(before);
        }
    }
    if (after != gaps_.end() && after->first == first + count) {
        length += after->second;
        gaps_.erase(after);
    }
    gaps_[start] = length;
    used_ -= count;
}

double MeshRanges::fragmentation() const {
    const std::uint32_t free = capacity_ - used_;
    if (free == 0) return 0;
    std::uint32_t longest = 0;
    for (const auto& [first, length] : gaps_) longest = std::max(longest, length);
    return 1 - static_cast<double>(longest) / free;
}

}  // namespace kino
