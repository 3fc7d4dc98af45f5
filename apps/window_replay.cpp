#include "apps/window_replay.h"

namespace kino {

std::optional<int> replay_in_window(const ReplayOptions&) {
    return std::nullopt;
}

}  // namespace kino
