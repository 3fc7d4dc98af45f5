#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/viz/host_copies.h"

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
        read_back(graph, from, buffer_, count_ * sizeof(T));
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
    auto texture = filled_texture(device, "test picture", extent, format, pixels.data(),
                                  pixels.size() * sizeof(T));
    if (!texture) throw std::runtime_error(texture.error().to_string());
    return std::move(*texture);
}

}  // namespace kino::test
