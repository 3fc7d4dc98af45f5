#include "tests/sensor/device/scenarios/truth.h"

#include <algorithm>

namespace kino::guest {

std::optional<fake::SentFrame> find_sent(const std::vector<fake::SentFrame>& sent,
                                         std::uint32_t ticks) {
    const auto found = std::ranges::find(sent, ticks, &fake::SentFrame::ticks);
    if (found == sent.end()) return std::nullopt;
    return *found;
}

std::vector<RowRange> spoilt_rows(const fake::SentFrame& frame, int payload, int row_bytes,
                                  int rows) {
    std::vector<RowRange> ranges;
    for (std::size_t i = 0; i < frame.fates.size(); ++i) {
        if (frame.fates[i] == fake::PacketFate::sent) continue;
        const int begin = static_cast<int>(i) * payload;
        const int end = std::min(begin + payload, row_bytes * rows);
        const int first = begin / row_bytes;
        const int past = (end + row_bytes - 1) / row_bytes;
        if (!ranges.empty() && first <= ranges.back().first + ranges.back().count) {
            ranges.back().count = std::max(ranges.back().count, past - ranges.back().first);
        } else {
            ranges.push_back({first, past - first});
        }
    }
    return ranges;
}

}  // namespace kino::guest
