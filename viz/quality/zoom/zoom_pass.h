#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "viz/graph/executor.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {

/// True where the host enlarges: on a CPU device its copy is several times faster than any of
/// Vulkan's (docs/zoom-rendering.md).
[[nodiscard]] bool enlarges_on_host(const gpu::Device& device, ZoomPath path);

/// The enlarging copy as passes of a frame, and the mapped memory that it takes on the host.
class ZoomPass {
  public:
    explicit ZoomPass(gpu::Device& device) : device_(device) {}

    /// Adds the copy of `small`, enlarged options.z times, into `target`, both RGBA8 or BGRA8. The
    /// target's pixel (0, 0) is pixel `offset` of the enlarged picture; the nearest pixel where
    /// that ends. On the host the target must take copies (TRANSFER_DST).
    [[nodiscard]] Result<graph::TextureId> add(graph::FrameGraph& graph, graph::TextureId small,
                                               graph::TextureId target, const ZoomOptions& options,
                                               glm::ivec2 offset = {0, 0});
    /// Gives the memory back.
    void clear();
    /// Bytes of mapped memory.
    [[nodiscard]] std::uint64_t bytes() const { return small_.bytes() + large_.bytes(); }

  private:
    gpu::Device& device_;
    gpu::Buffer small_;
    gpu::Buffer large_;
};

}  // namespace kino
