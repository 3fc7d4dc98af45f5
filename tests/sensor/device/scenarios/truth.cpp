#include "tests/sensor/device/scenarios/truth.h"

#include <algorithm>

namespace kino::guest {

std::optional<fake::SentFrame> find_sent(const std::vector<fake::SentFrame>& sent,
                                         std::uint32_t ticks) {
    const auto found = std::ranges::find(sent, ticks, &fake::SentFrame::ticks);
    if (found == sent.end()) return std::nullopt;
    return *found;
}

std::vector<RowRange> spoilt_rows(const fake::SentFrame& frame, int row_bytes) {
    std::vector<RowRange> ranges;
    int begin = 0;
    for (const fake::SentPacket& packet : frame.packets) {
        const int end = begin + packet.bytes;
        const int spoilt = begin + packet.intact;
        begin = end;
        if (spoilt == end) continue;
        const int first = spoilt / row_bytes;
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
