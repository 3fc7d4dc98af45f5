#include "viz/graph/history.h"

#include "base/check.h"

namespace kino::graph {

void HistoryBook::begin_frame() {
    std::erase_if(entries_, [](const auto& item) { return !item.second.wanted; });
    for (auto& [key, entry] : entries_) entry.wanted = false;
}

void HistoryBook::cut() {
    for (auto& [key, entry] : entries_) entry.cut = true;
}

const HistoryBook::Entry& HistoryBook::want(const std::string& key, std::uint64_t bytes) {
    auto [it, fresh] = entries_.try_emplace(key);
    Entry& entry = it->second;
    KINO_CHECK(!entry.wanted);  // two passes would each believe to own it
    if (fresh || entry.bytes != bytes) {
        entry = {.key = key, .bytes = bytes, .current = 0, .valid = false, .wanted = true};
        return entry;
    }
    // A cut makes the first frame after it invalid, and only that one.
    entry.current ^= 1;
    entry.valid = !entry.cut;
    entry.cut = false;
    entry.wanted = true;
    return entry;
}

std::uint64_t HistoryBook::total_bytes() const {
    std::uint64_t total = 0;
    for (const auto& [key, entry] : entries_) {
        if (entry.wanted) total += 2 * entry.bytes;
    }
    return total;
}

}  // namespace kino::graph
