#include "viz/gpu/resource.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/check.h"

namespace kino::gpu {

Result<Buffer> Buffer::create(Device& device, const std::string& name, VkDeviceSize bytes,
                              MemoryUse use) {
    KINO_CHECK(bytes > 0);
    Buffer buffer;
    buffer.device_ = &device;
    buffer.bytes_ = bytes;
    const VkBufferCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = bytes,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT};
    KINO_VK_TRY(vkCreateBuffer(device.handle(), &create, nullptr, &buffer.buffer_),
                "creating buffer " + name);
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device.handle(), buffer.buffer_, &needs);
    bool host_visible = false;
    KINO_ASSIGN(buffer.memory_, device.allocate(needs, use, name, host_visible));
    buffer.allocated_ = needs.size;
    KINO_VK_TRY(vkBindBufferMemory(device.handle(), buffer.buffer_, buffer.memory_, 0),
                "binding buffer " + name);
    for (const auto& [view, format, size] :
         {std::tuple(&buffer.words_, VK_FORMAT_R32_UINT, VkDeviceSize{4}),
          std::tuple(&buffer.word_pairs_, VK_FORMAT_R32G32_UINT, VkDeviceSize{8}),
          std::tuple(&buffer.word_quads_, VK_FORMAT_R32G32B32A32_UINT, VkDeviceSize{16})}) {
        const VkDeviceSize texels = std::min(bytes / size, device.info().max_texels);
        if (texels == 0) continue;
        const VkBufferViewCreateInfo as_texels{.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                               .buffer = buffer.buffer_,
                                               .format = format,
                                               .range = texels * size};
        KINO_VK_TRY(vkCreateBufferView(device.handle(), &as_texels, nullptr, view),
                    "creating a view of " + name);
    }
    if (use != MemoryUse::device) {
        KINO_VK_TRY(
            vkMapMemory(device.handle(), buffer.memory_, 0, VK_WHOLE_SIZE, 0, &buffer.mapped_),
            "mapping buffer " + name);
    }
    return buffer;
}

Buffer::~Buffer() {
    if (device_ == nullptr) return;
    vkDestroyBufferView(device_->handle(), words_, nullptr);
    vkDestroyBufferView(device_->handle(), word_pairs_, nullptr);
    vkDestroyBufferView(device_->handle(), word_quads_, nullptr);
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    if (memory_ != VK_NULL_HANDLE) device_->release(memory_, allocated_);
}

Buffer::Buffer(Buffer&& other) noexcept {
    *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(words_, other.words_);
    std::swap(word_pairs_, other.word_pairs_);
    std::swap(word_quads_, other.word_quads_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    std::swap(allocated_, other.allocated_);
    std::swap(mapped_, other.mapped_);
    return *this;
}

Result<Texture> Texture::create(Device& device, const std::string& name, VkExtent2D extent,
                                VkFormat format, std::uint32_t samples, bool storage) {
    Texture texture;
    texture.samples_ = samples;
    texture.storage_ = storage;
    texture.device_ = &device;
    texture.extent_ = extent;
    texture.format_ = format;
    const bool depth = is_depth_format(format);
    const VkImageCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {extent.width, extent.height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = static_cast<VkSampleCountFlagBits>(samples),
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                 static_cast<VkImageUsageFlags>(storage ? VK_IMAGE_USAGE_STORAGE_BIT : 0) |
                 static_cast<VkImageUsageFlags>(depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                      : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT)};
    KINO_VK_TRY(vkCreateImage(device.handle(), &create, nullptr, &texture.image_),
                "creating image " + name);
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device.handle(), texture.image_, &needs);
    bool host_visible = false;
    KINO_ASSIGN(texture.memory_, device.allocate(needs, MemoryUse::device, name, host_visible));
    texture.allocated_ = needs.size;
    KINO_VK_TRY(vkBindImageMemory(device.handle(), texture.image_, texture.memory_, 0),
                "binding image " + name);
    const VkImageViewCreateInfo view{
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = texture.image_,
        .viewType = VK_IMAGE_VIEW_TYPE_2D,
        .format = format,
        .subresourceRange = {.aspectMask = static_cast<VkImageAspectFlags>(
                                 depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT),
                             .levelCount = 1,
                             .layerCount = 1}};
    KINO_VK_TRY(vkCreateImageView(device.handle(), &view, nullptr, &texture.view_),
                "creating the view of " + name);
    return texture;
}

Texture::~Texture() {
    if (device_ == nullptr) return;
    vkDestroyImageView(device_->handle(), view_, nullptr);
    vkDestroyImage(device_->handle(), image_, nullptr);
    if (memory_ != VK_NULL_HANDLE) device_->release(memory_, allocated_);
}

Texture::Texture(Texture&& other) noexcept {
    *this = std::move(other);
}

Texture& Texture::operator=(Texture&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(memory_, other.memory_);
    std::swap(allocated_, other.allocated_);
    std::swap(extent_, other.extent_);
    std::swap(format_, other.format_);
    std::swap(samples_, other.samples_);
    std::swap(storage_, other.storage_);
    return *this;
}

bool is_depth_format(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT;
}

std::uint32_t bytes_per_pixel(VkFormat format) {
    switch (format) {
        case VK_FORMAT_R8_UNORM:
            return 1;
        case VK_FORMAT_R8G8B8A8_UNORM:
        case VK_FORMAT_B8G8R8A8_UNORM:
        case VK_FORMAT_R32_SFLOAT:
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R16G16_SNORM:
        case VK_FORMAT_D32_SFLOAT:
            return 4;
        case VK_FORMAT_R16G16B16A16_SFLOAT:
        case VK_FORMAT_R16G16B16A16_UNORM:
        case VK_FORMAT_R32G32_UINT:
        case VK_FORMAT_R32G32_SFLOAT:
            return 8;
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return 16;
        default:
            break;
    }
    KINO_CHECK_EQ(static_cast<int>(format), -1);  // a format Kinoscope does not use
    return 0;
}

}  // namespace kino::gpu
