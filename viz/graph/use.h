#pragma once

#include <cstdint>

#include "viz/gpu/vulkan.h"

namespace kino::graph {

/// How a pass touches a resource; decides the barrier in front of it.
enum class Use : std::uint8_t {
    compute_read,
    compute_write,  ///< storage writes, atomics, read-modify-write
    vertex_read,    ///< storage or texture reads before rasterisation
    fragment_read,  ///< storage or texture reads in a fragment shader
    indirect_read,
    index_read,
    attribute_read,  ///< as a vertex buffer
    transfer_read,
    transfer_write,
    color_attachment,
    depth_attachment,
    host_read,   ///< mapped memory read after the fence, or by a pass on the host
    host_write,  ///< mapped memory written by a pass on the host
};

struct Access {
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
    bool writes = false;
};

/// Stages and accesses of synchronization2 that `use` stands for.
[[nodiscard]] Access access_of(Use use);

}  // namespace kino::graph
