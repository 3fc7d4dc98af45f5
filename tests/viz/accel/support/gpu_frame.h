#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "viz/graph/executor.h"

namespace kino::test {

/// Reads the first `count` values of a graph's buffer back after the frame, or as many as it has.
/// Must live until then.
template <class T>
class Readback {
  public:
    Readback(gpu::Device& device, graph::FrameGraph& graph, graph::BufferId from, std::size_t count)
        : count_(std::min<std::size_t>(count,
                                       graph.resources()[from.index].buffer.bytes / sizeof(T))) {
        auto made =
            gpu::Buffer::create(device, "readback", std::max<std::size_t>(count_, 1) * sizeof(T),
                                gpu::MemoryUse::readback);
        if (!made) throw std::runtime_error(made.error().to_string());
        buffer_ = std::move(*made);
        graph::BufferId to = graph.import_buffer("readback", buffer_);
        graph.add_pass(
            "test/readback", "test",
            [&](graph::PassBuilder& b) {
                b.read(from, graph::Use::transfer_read);
                to = b.write(to, graph::Use::transfer_write);
                b.side_effect();
            },
            [from, to, bytes = count_ * sizeof(T)](graph::PassContext& c) {
                const VkBufferCopy region{.size = bytes};
                vkCmdCopyBuffer(c.commands().handle(), c.buffer(from), c.buffer(to), 1, &region);
            });
    }
    [[nodiscard]] std::vector<T> values() const {
        const auto all = buffer_.read<T>();
        return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count_)};
    }

  private:
    gpu::Buffer buffer_;
    std::size_t count_;
};

/// A texture with these pixels, in the GENERAL layout.
template <class T>
gpu::Texture make_texture(gpu::Device& device, VkExtent2D extent, VkFormat format,
                          const std::vector<T>& pixels) {
    auto texture = gpu::Texture::create(device, "test picture", extent, format);
    auto buffer = gpu::Buffer::create(device, "test pixels", pixels.size() * sizeof(T),
                                      gpu::MemoryUse::upload);
    if (!texture || !buffer) throw std::runtime_error("no memory for a test picture");
    buffer->write(std::span<const T>(pixels));
    const auto copied = device.submit_and_wait([&](VkCommandBuffer commands) {
        gpu::Commands(device, commands).to_general(texture->image());
        const VkBufferImageCopy region{
            .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .imageExtent = {extent.width, extent.height, 1}};
        vkCmdCopyBufferToImage(commands, buffer->handle(), texture->image(),
                               VK_IMAGE_LAYOUT_GENERAL, 1, &region);
        gpu::Commands(device, commands).full_barrier();
    });
    if (!copied) throw std::runtime_error(copied.error().to_string());
    return std::move(*texture);
}

}  // namespace kino::test
