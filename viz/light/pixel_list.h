#pragma once

#include <cstdint>

#include "viz/graph/graph.h"

namespace kino {

/// Single pixels of a picture that are worked on again.
struct PixelList {
    graph::BufferId pixels;  ///< y << 16 | x
    /// VkDispatchIndirectCommand of workgroups of 64 at byte 0, the number of pixels at byte 12.
    graph::BufferId dispatch;
    std::uint32_t most = 0;  ///< there are never more
};

}  // namespace kino
