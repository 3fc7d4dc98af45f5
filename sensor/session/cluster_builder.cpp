#include "sensor/session/cluster_builder.h"

#include <algorithm>

#include "base/check.h"
#include "sensor/session/crc32.h"
#include "sensor/session/ebml_writer.h"
#include "sensor/session/frame_note.h"
#include "sensor/session/session_layout.h"

namespace kino {
namespace {

using namespace ebml;

constexpr std::int64_t kMaxTicks = 500'000'000 / kNsPerTick;
constexpr std::size_t kMaxBytes = std::size_t{2} << 20;
constexpr std::size_t kBlockHead = 4;  // track number, 16-bit time, flags
// ID and 8-byte size; CRC-32; Timestamp in 8 bytes.
constexpr std::size_t kCrcAt = 12;
constexpr std::size_t kTimestampAt = kCrcAt + 6;
constexpr std::size_t kHead = kTimestampAt + 10;

}  // namespace

bool ClusterBuilder::fits(const ClusterBlock& block) const {
    if (blocks_.empty()) return true;
    const std::int64_t first = std::min(first_tick_, block.tick);
    const std::int64_t last = std::max(last_tick_, block.tick);
    return last - first < kMaxTicks && bytes_.size() + block.data.size() <= kMaxBytes;
}

void ClusterBuilder::add(const ClusterBlock& block) {
    KINO_CHECK(block.tick >= 0 && block.track > 0 && block.track <= kMaxTracks);
    if (bytes_.empty()) bytes_.resize(kHead);
    EbmlWriter tail;
    if (block.duration_ticks) {
        tail.put_unsigned(kBlockDuration, static_cast<std::uint64_t>(*block.duration_ticks));
    }
    if (!block.note.empty()) {
        EbmlWriter more;
        more.put_unsigned(kBlockAddId, kFrameNoteId);
        more.put_binary(kBlockAdditional, block.note);
        EbmlWriter additions;
        additions.put_master(kBlockMore, more);
        tail.put_master(kBlockAdditions, additions);
    }
    EbmlWriter block_head;
    block_head.put_head(kBlock, kBlockHead + block.data.size());
    EbmlWriter head;
    head.put_head(kBlockGroup, block_head.size() + kBlockHead + block.data.size() + tail.size());
    head.put_raw(block_head.bytes());
    head.put_byte(static_cast<std::uint8_t>(0x80 | block.track));
    const std::size_t time_at = bytes_.size() + head.size();
    head.put_big_endian(0, 3);
    const auto append = [this](std::span<const std::uint8_t> part) {
        bytes_.insert(bytes_.end(), part.begin(), part.end());
    };
    append(head.bytes());
    append(block.data);
    append(tail.bytes());

    first_tick_ = blocks_.empty() ? block.tick : std::min(first_tick_, block.tick);
    last_tick_ = blocks_.empty() ? block.tick : std::max(last_tick_, block.tick);
    blocks_.push_back({time_at, block.tick});
}

std::span<const std::uint8_t> ClusterBuilder::finish() {
    KINO_CHECK(!blocks_.empty());
    for (const Placed& block : blocks_) {
        const std::int64_t time = block.tick - first_tick_;
        KINO_CHECK(time >= 0 && time <= 32767);
        bytes_[block.time_at] = static_cast<std::uint8_t>(time >> 8);
        bytes_[block.time_at + 1] = static_cast<std::uint8_t>(time);
    }
    EbmlWriter timestamp;
    timestamp.put_signed(kTimestamp, first_tick_);
    std::copy(timestamp.bytes().begin(), timestamp.bytes().end(), bytes_.begin() + kTimestampAt);
    const std::uint32_t sum = crc32(std::span(bytes_).subspan(kTimestampAt));
    EbmlWriter head;
    head.put_big_endian(kCluster, 4);
    head.put_big_endian((bytes_.size() - kCrcAt) | std::uint64_t{1} << 56, 8);
    head.put_head(kCrc32, 4);
    for (int i = 0; i < 4; ++i) head.put_byte(static_cast<std::uint8_t>(sum >> (8 * i)));
    KINO_CHECK_EQ(head.size(), kTimestampAt);
    std::copy(head.bytes().begin(), head.bytes().end(), bytes_.begin());
    return bytes_;
}

void ClusterBuilder::clear() {
    bytes_.clear();
    blocks_.clear();
}

}  // namespace kino
