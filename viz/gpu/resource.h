#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "base/check.h"
#include "viz/gpu/device.h"

namespace kino::gpu {

/// A buffer with memory of its own; may be bound as storage, texels, indirect, index and copied.
/// Upload and readback buffers stay mapped. Move-only; must die before its Device.
class Buffer {
  public:
    Buffer() = default;
    [[nodiscard]] static Result<Buffer> create(Device& device, const std::string& name,
                                               VkDeviceSize bytes, MemoryUse use);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    [[nodiscard]] VkBuffer handle() const { return buffer_; }
    [[nodiscard]] VkDeviceSize bytes() const { return bytes_; }
    /// The bytes as texels of one, two or four 32-bit numbers, for Binding::words and so on; null
    /// where the buffer is too short for one, and cut off at the device's limit of texels.
    [[nodiscard]] VkBufferView words() const { return words_; }
    [[nodiscard]] VkBufferView word_pairs() const { return word_pairs_; }
    [[nodiscard]] VkBufferView word_quads() const { return word_quads_; }
    [[nodiscard]] bool empty() const { return buffer_ == VK_NULL_HANDLE; }
    /// Null unless the memory is mapped.
    [[nodiscard]] void* mapped() const { return mapped_; }

    template <class T>
    void write(std::span<const T> values, VkDeviceSize byte_offset = 0) {
        KINO_CHECK(mapped_ != nullptr && byte_offset + values.size_bytes() <= bytes_);
        std::memcpy(static_cast<char*>(mapped_) + byte_offset, values.data(), values.size_bytes());
    }
    template <class T>
    [[nodiscard]] std::span<const T> read() const {
        KINO_CHECK(mapped_ != nullptr);
        return {static_cast<const T*>(mapped_), bytes_ / sizeof(T)};
    }

  private:
    Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkBufferView words_ = VK_NULL_HANDLE;
    VkBufferView word_pairs_ = VK_NULL_HANDLE;
    VkBufferView word_quads_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize bytes_ = 0;
    VkDeviceSize allocated_ = 0;
    void* mapped_ = nullptr;
};

/// A 2D image with one level, its view and its memory; used in the GENERAL layout throughout. With
/// several samples a pixel shaders read it as a sampler2DMS.
class Texture {
  public:
    Texture() = default;
    [[nodiscard]] static Result<Texture> create(Device& device, const std::string& name,
                                                VkExtent2D extent, VkFormat format,
                                                std::uint32_t samples = 1, bool storage = false);
    ~Texture();
    Texture(Texture&& other) noexcept;
    Texture& operator=(Texture&& other) noexcept;

    [[nodiscard]] VkImage image() const { return image_; }
    [[nodiscard]] VkImageView view() const { return view_; }
    [[nodiscard]] VkExtent2D extent() const { return extent_; }
    [[nodiscard]] VkFormat format() const { return format_; }
    [[nodiscard]] std::uint32_t samples() const { return samples_; }
    /// Compute shaders may write single texels (Binding::image).
    [[nodiscard]] bool storage() const { return storage_; }
    [[nodiscard]] VkDeviceSize bytes() const { return allocated_; }
    [[nodiscard]] bool empty() const { return image_ == VK_NULL_HANDLE; }

  private:
    Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize allocated_ = 0;
    VkExtent2D extent_{};
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    std::uint32_t samples_ = 1;
    bool storage_ = false;
};

[[nodiscard]] bool is_depth_format(VkFormat format);
/// Bytes of one pixel of the formats Kinoscope uses.
[[nodiscard]] std::uint32_t bytes_per_pixel(VkFormat format);

}  // namespace kino::gpu
