#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kino {

/// One block on its way into a cluster.
struct ClusterBlock {
    int track = 0;
    std::int64_t tick = 0;  ///< 0 or more, since the session's origin
    std::span<const std::uint8_t> data;
    std::span<const std::uint8_t> note;          ///< frame note; empty for none
    std::optional<std::int64_t> duration_ticks;  ///< of texts
};

/// A Cluster in memory: of known size, CRC-32 first, every block a BlockGroup.
class ClusterBuilder {
  public:
    /// Would the block keep the cluster within 500 ms and 2 MB? A single block always fits.
    [[nodiscard]] bool fits(const ClusterBlock& block) const;
    void add(const ClusterBlock& block);

    [[nodiscard]] bool empty() const { return blocks_.empty(); }
    [[nodiscard]] std::size_t block_count() const { return blocks_.size(); }
    [[nodiscard]] std::int64_t first_tick() const { return first_tick_; }

    /// The whole element; valid until the next call. The builder is empty after clear().
    [[nodiscard]] std::span<const std::uint8_t> finish();
    void clear();

  private:
    struct Placed {
        std::size_t time_at = 0;  ///< where the block's 16-bit time goes
        std::int64_t tick = 0;
    };
    std::vector<std::uint8_t> bytes_;
    std::vector<Placed> blocks_;
    std::int64_t first_tick_ = 0;
    std::int64_t last_tick_ = 0;
};

}  // namespace kino
