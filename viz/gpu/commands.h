#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "viz/gpu/pipeline.h"

namespace kino::gpu {

/// What a shader binding is given: a buffer range, or an image in the GENERAL layout.
struct Bound {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    VkDeviceSize bytes = VK_WHOLE_SIZE;
    VkBufferView words = VK_NULL_HANDLE;       ///< the whole buffer, for Binding::words
    VkBufferView word_pairs = VK_NULL_HANDLE;  ///< and for Binding::word_pairs
    VkBufferView word_quads = VK_NULL_HANDLE;  ///< and for Binding::word_quads
    VkImageView view = VK_NULL_HANDLE;
    bool linear = false;  ///< filter of a texture
};

/// A colour or depth target of one draw. `clear`: start from `clear_value`, else keep.
struct Target {
    VkImageView view = VK_NULL_HANDLE;
    bool clear = false;
    VkClearValue clear_value{};
};

/// The recording face of a command buffer: bind a pipeline, give its resources in binding order,
/// draw or dispatch. Knows no resource states; viz/graph places the barriers.
class Commands {
  public:
    Commands(Device& device, VkCommandBuffer buffer) : device_(device), buffer_(buffer) {}

    [[nodiscard]] VkCommandBuffer handle() const { return buffer_; }
    [[nodiscard]] Device& device() const { return device_; }

    /// Binds `pipeline` with one resource for each of its bindings.
    void bind(const Pipeline& pipeline, std::span<const Bound> resources);
    void bind(const Pipeline& pipeline, std::initializer_list<Bound> resources) {
        bind(pipeline, std::span(resources.begin(), resources.size()));
    }
    template <class T>
    void constants(const T& values) {
        push(&values, sizeof(T));
    }
    void constants(std::span<const std::byte> values) { push(values.data(), values.size()); }

    void dispatch(std::uint32_t groups_x, std::uint32_t groups_y = 1);
    /// The same for groups from `first_x`, `first_y` on.
    void dispatch_from(std::uint32_t first_x, std::uint32_t first_y, std::uint32_t groups_x,
                       std::uint32_t groups_y);
    void dispatch_indirect(VkBuffer buffer, VkDeviceSize offset);
    void fill(VkBuffer buffer, std::uint32_t value);
    void fill(VkBuffer buffer, std::uint64_t offset, std::uint64_t bytes, std::uint32_t value);
    /// Writes a few words at the front of a buffer; at most 64 KB.
    void update(VkBuffer buffer, std::span<const std::uint32_t> words);

    void begin_rendering(VkExtent2D extent, std::span<const Target> colors, const Target* depth);
    void end_rendering();
    /// Limits drawing to a rectangle of the targets; inside begin/end_rendering.
    void viewport(VkRect2D rect);
    /// Limits what is written without moving it.
    void scissor(VkRect2D rect);
    void draw(std::uint32_t vertices, std::uint32_t instances = 1);
    void draw_indirect(VkBuffer buffer, VkDeviceSize offset = 0);  ///< one VkDrawIndirectCommand
    void draw_indexed(VkBuffer indices, std::uint32_t count);      ///< 32-bit indices
    /// Buffers of the pipeline's vertex streams from stream `first` on, each from its start.
    void vertex_buffers(std::span<const VkBuffer> buffers, std::uint32_t first = 0);
    void index_buffer(VkBuffer indices);  ///< 32-bit indices, for the calls below
    void draw_indexed(const VkDrawIndexedIndirectCommand& call);
    /// `draws` VkDrawIndexedIndirectCommand one after the other from `offset` on.
    void draw_indexed_indirect(VkBuffer buffer, std::uint32_t draws, VkDeviceSize offset = 0);
    /// As many as the word at `count_offset` of `count` says, at most `most_draws`.
    void draw_indexed_indirect_count(VkBuffer buffer, VkBuffer count, std::uint32_t most_draws,
                                     VkDeviceSize offset = 0, VkDeviceSize count_offset = 0);

    /// Takes a colour image from any layout to GENERAL, contents lost; to_present() hands a
    /// swapchain image over to the presentation engine, contents kept.
    void to_general(VkImage image);
    void to_present(VkImage image);

    /// Everything written so far is visible to everything that follows.
    void full_barrier();

  private:
    void change_layout(VkImage image, VkImageLayout from, VkImageLayout to);
    void push(const void* values, std::size_t bytes);

    Device& device_;
    VkCommandBuffer buffer_;
    const Pipeline* bound_ = nullptr;
};

}  // namespace kino::gpu
