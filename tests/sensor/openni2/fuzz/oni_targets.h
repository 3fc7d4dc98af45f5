#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/check.h"
#include "sensor/openni2/oni_depth_codec.h"
#include "sensor/openni2/oni_walk.h"

/// What the ONI parsers promise for any bytes at all. Shared by the libFuzzer driver and by
/// mutation_test.cpp.
namespace kino::fuzz {

using Bytes = std::span<const std::uint8_t>;

class MemoryInput final : public OniInput {
  public:
    explicit MemoryInput(Bytes bytes) : bytes_(bytes) {}
    std::uint64_t size() const override { return bytes_.size(); }
    bool read(std::uint64_t position, std::span<std::uint8_t> out) const override {
        if (position > bytes_.size() || out.size() > bytes_.size() - position) return false;
        std::ranges::copy(bytes_.subspan(position, out.size()), out.begin());
        return true;
    }

  private:
    Bytes bytes_;
};

/// The walk accepts only files whose records all lie inside and follow each other.
inline bool oni(Bytes bytes) {
    const MemoryInput input(bytes);
    const auto records = walk_oni(input);
    if (!records) return false;
    std::uint64_t end = 0;
    for (const OniData& data : records->data) {
        KINO_CHECK_LE(end, data.position);
        KINO_CHECK_LT(data.position, data.next);
        KINO_CHECK_LE(data.next, bytes.size());
        KINO_CHECK_LT(data.node, records->nodes.size());
        end = data.next;
        const OniNode& node = records->nodes[data.node];
        const auto payload = read_payload(input, data);
        KINO_CHECK(payload.has_value());
        if (node.width * node.height > 10000) continue;
        std::vector<std::uint16_t> pixels(static_cast<std::size_t>(node.width * node.height));
        for (const bool table : {false, true}) {
            const bool sound = check_16z(*payload, table, pixels.size());
            KINO_CHECK_EQ(decode_16z(*payload, table, pixels), sound);
        }
    }
    for (std::size_t n = 0; n < records->nodes.size(); ++n) {
        const OniNode& node = records->nodes[n];
        KINO_CHECK(node.seek_table.empty() || node.seek_table.size() == node.frames.size() + 1);
        for (std::size_t i = 0; i < node.frames.size(); ++i) {
            KINO_CHECK_EQ(records->data[node.frames[i]].node, n);
        }
    }
    return true;
}

/// A payload whose size the first bytes state.
inline void depth_codec(Bytes bytes) {
    if (bytes.size() < 2) return;
    std::vector<std::uint16_t> pixels(bytes[0] * std::size_t{4});
    const bool table = (bytes[1] & 1) != 0;
    const bool sound = check_16z(bytes.subspan(2), table, pixels.size());
    KINO_CHECK_EQ(decode_16z(bytes.subspan(2), table, pixels), sound);
}

}  // namespace kino::fuzz
