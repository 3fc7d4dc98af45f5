#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/stage/cast.h"

namespace kino::demo {

/// Somebody who plays. Their place (0 or 1) decides which brush and which colours are theirs.
struct Player {
    std::uint32_t id = 0;  ///< of the body; 0: nobody
    bool primary = false;  ///< changes scenes and the view for both
    double away_s = 0;
};

/// Up to two who play: the recogniser's primary user, and one more who waved while somebody else
/// was it.
class Players {
  public:
    static constexpr std::size_t kMost = 2;
    static constexpr double kAwayS = 2.5;  ///< who is not seen for so long has left

    enum class Change : std::uint8_t { none, joined, took_over, full };
    /// The recogniser says that this is the primary user now. Who was it goes on as second.
    Change engage(std::uint32_t id);
    /// A wave of somebody who is not the primary user.
    Change join(std::uint32_t id);
    /// True if they played. They go on as second if they are still there.
    bool release(std::uint32_t id, bool still_there);
    /// Ids of those who left meanwhile.
    [[nodiscard]] std::vector<std::uint32_t> step(double dt_s, std::span<const CastMember> cast);
    void clear() { all_ = {}; }

    [[nodiscard]] std::span<const Player> all() const { return all_; }
    [[nodiscard]] const Player* primary() const;
    /// Place of a body's player; -1: does not play.
    [[nodiscard]] int place_of(std::uint32_t id) const;
    [[nodiscard]] bool anybody() const;

  private:
    Player* free_place();

    std::array<Player, kMost> all_;
};

}  // namespace kino::demo
