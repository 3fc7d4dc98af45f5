#pragma once

#include <cstddef>
#include <cstring>
#include <string>

#include "viz/graph/executor.h"
#include "viz/graph/graph.h"

namespace kino::test {

/// All of a picture with one level.
[[nodiscard]] inline VkBufferImageCopy whole_picture(VkExtent2D extent) {
    return {.imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .imageExtent = {extent.width, extent.height, 1}};
}

/// Adds a pass that copies a texture, row by row, to the front of a buffer that the host reads
/// after the frame; the buffer must live until then.
inline void read_back(graph::FrameGraph& graph, graph::TextureId from, const gpu::Buffer& into) {
    graph::BufferId host = graph.import_buffer("readback", into);
    graph.add_pass(
        "rig/read", "readback",
        [&](graph::PassBuilder& b) {
            b.read(from, graph::Use::transfer_read);
            host = b.write(host, graph::Use::transfer_write);
        },
        [from, host](graph::PassContext& c) {
            const graph::TextureDesc size = c.desc(from);
            const VkBufferImageCopy region = whole_picture({size.width, size.height});
            vkCmdCopyImageToBuffer(c.commands().handle(), c.image(from), VK_IMAGE_LAYOUT_GENERAL,
                                   c.buffer(host), 1, &region);
        });
    graph.require(host);
}

/// The same for the first `bytes` of a buffer.
inline void read_back(graph::FrameGraph& graph, graph::BufferId from, const gpu::Buffer& into,
                      std::uint64_t bytes) {
    graph::BufferId host = graph.import_buffer("readback", into);
    graph.add_pass(
        "rig/read", "readback",
        [&](graph::PassBuilder& b) {
            b.read(from, graph::Use::transfer_read);
            host = b.write(host, graph::Use::transfer_write);
        },
        [=](graph::PassContext& c) {
            const VkBufferCopy region{.size = bytes};
            vkCmdCopyBuffer(c.commands().handle(), c.buffer(from), c.buffer(host), 1, &region);
        });
    graph.require(host);
}

/// A texture with these pixels, rows without gaps, in the GENERAL layout.
[[nodiscard]] inline Result<gpu::Texture> filled_texture(gpu::Device& device,
                                                         const std::string& name, VkExtent2D extent,
                                                         VkFormat format, const void* pixels,
                                                         std::size_t bytes) {
    KINO_ASSIGN(gpu::Texture texture, gpu::Texture::create(device, name, extent, format));
    KINO_ASSIGN(gpu::Buffer staging,
                gpu::Buffer::create(device, name, bytes, gpu::MemoryUse::upload));
    std::memcpy(staging.mapped(), pixels, bytes);
    const auto moved = device.submit_and_wait([&](VkCommandBuffer buffer) {
        gpu::Commands commands(device, buffer);
        commands.to_general(texture.image());
        commands.full_barrier();
        const VkBufferImageCopy region = whole_picture(extent);
        vkCmdCopyBufferToImage(buffer, staging.handle(), texture.image(), VK_IMAGE_LAYOUT_GENERAL,
                               1, &region);
        commands.full_barrier();
    });
    if (!moved) return fail(moved.error());
    return texture;
}

}  // namespace kino::test
