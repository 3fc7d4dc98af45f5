#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/frame.h"
#include "tests/sensor/device/fake_kinect/packet_stream.h"

namespace kino::guest {

/// The frame sent with that device time.
[[nodiscard]] std::optional<fake::SentFrame> find_sent(const std::vector<fake::SentFrame>& sent,
                                                       std::uint32_t ticks);

/// Rows that have a byte which never arrived intact, as rising ranges that do not touch.
/// `row_bytes` packed bytes a row.
[[nodiscard]] std::vector<RowRange> spoilt_rows(const fake::SentFrame& frame, int row_bytes);

/// Pixels whose value is not that of `truth`; all of them where the sizes differ.
template <class Pixel>
[[nodiscard]] std::int64_t count_different(std::span<const Pixel> got,
                                           std::span<const Pixel> truth) {
    if (got.size() != truth.size()) return static_cast<std::int64_t>(truth.size());
    std::int64_t count = 0;
    for (std::size_t i = 0; i < got.size(); ++i) count += got[i] != truth[i] ? 1 : 0;
    return count;
}

}  // namespace kino::guest
