#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "viz/graph/executor.h"

namespace kino {

/// Buffers are pooled by size, and the number of lights changes from frame to frame.
template <class T>
[[nodiscard]] std::uint64_t roomy_bytes(std::size_t count) {
    return std::bit_ceil(std::max<std::size_t>(count, 16)) * sizeof(T);
}

/// Any number of bytes through the command buffer itself, which takes 64 KB at a time.
template <class T>
void write_buffer(graph::PassContext& c, graph::BufferId id, const std::vector<T>& values) {
    constexpr std::size_t kMost = 65536;
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    const std::size_t total = values.size() * sizeof(T);
    for (std::size_t done = 0; done < total; done += kMost) {
        vkCmdUpdateBuffer(c.commands().handle(), c.buffer(id), done, std::min(kMost, total - done),
                          bytes + done);
    }
}

}  // namespace kino
