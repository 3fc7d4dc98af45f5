#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace kino {

/// Ranges of one buffer, first fit, neighbours merged: where meshes lie in the pools. Knows no
/// device.
class MeshRanges {
  public:
    explicit MeshRanges(std::uint32_t capacity = 0);

    /// First of `count` (at least 1) free units in a row; none where no gap is long enough.
    [[nodiscard]] std::optional<std::uint32_t> take(std::uint32_t count);
    /// Gives back what take() gave; the pair must match (checked).
    void give_back(std::uint32_t first, std::uint32_t count);

    [[nodiscard]] std::uint32_t capacity() const { return capacity_; }
    [[nodiscard]] std::uint32_t used() const { return used_; }
    /// Share of the free units that lie outside the longest gap: 0 where one gap has them all.
    [[nodiscard]] double fragmentation() const;
    /// First unit and length of every gap, ascending.
    [[nodiscard]] const std::map<std::uint32_t, std::uint32_t>& gaps() const { return gaps_; }

  private:
    std::uint32_t capacity_ = 0;
    std::uint32_t used_ = 0;
    std::map<std::uint32_t, std::uint32_t> gaps_;
};

}  // namespace kino
