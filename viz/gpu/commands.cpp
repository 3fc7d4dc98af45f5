#include "viz/gpu/commands.h"

#include <array>
#include <vector>

#include "base/check.h"

namespace kino::gpu {

void Commands::bind(const Pipeline& pipeline, std::span<const Bound> resources) {
    KINO_CHECK_EQ(resources.size(), pipeline.bindings.size());
    bound_ = &pipeline;
    vkCmdBindPipeline(buffer_, pipeline.bind_point, pipeline.handle);
    if (resources.size() == 0) return;
    constexpr std::size_t kMost = 16;
    KINO_CHECK_LE(resources.size(), kMost);
    std::array<VkDescriptorBufferInfo, kMost> buffers{};
    std::array<VkDescriptorImageInfo, kMost> images{};
    std::array<VkBufferView, kMost> texels{};
    std::array<VkWriteDescriptorSet, kMost> writes{};
    std::uint32_t i = 0;
    for (const Bound& resource : resources) {
        VkWriteDescriptorSet& write = writes[i];
        write = {
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstBinding = i, .descriptorCount = 1};
        const Binding kind = pipeline.bindings[i];
        write.descriptorType = descriptor_type(kind);
        if (kind == Binding::storage) {
            KINO_CHECK(resource.buffer != VK_NULL_HANDLE);
            buffers[i] = {resource.buffer, resource.offset, resource.bytes};
            write.pBufferInfo = &buffers[i];
        } else if (kind == Binding::image) {
            KINO_CHECK(resource.view != VK_NULL_HANDLE);
            images[i] = {VK_NULL_HANDLE, resource.view, VK_IMAGE_LAYOUT_GENERAL};
            write.pImageInfo = &images[i];
        } else if (kind != Binding::texture) {
            texels[i] = kind == Binding::words        ? resource.words
                        : kind == Binding::word_pairs ? resource.word_pairs
                                                      : resource.word_quads;
            KINO_CHECK(texels[i] != VK_NULL_HANDLE);
            write.pTexelBufferView = &texels[i];
        } else {
            KINO_CHECK(resource.view != VK_NULL_HANDLE);
            images[i] = {resource.linear ? device_.linear_sampler() : device_.nearest_sampler(),
                         resource.view, VK_IMAGE_LAYOUT_GENERAL};
            write.pImageInfo = &images[i];
        }
        ++i;
    }
    vkCmdPushDescriptorSetKHR(buffer_, pipeline.bind_point, pipeline.layout, 0, i, writes.data());
}

void Commands::push(const void* values, std::size_t bytes) {
    KINO_CHECK(bound_ != nullptr);
    KINO_CHECK_EQ(bytes, bound_->push_bytes);
    VkShaderStageFlags stages = VK_SHADER_STAGE_COMPUTE_BIT;
    if (bound_->bind_point == VK_PIPELINE_BIND_POINT_GRAPHICS) {
        stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
        if (bound_->has_geometry) stages |= VK_SHADER_STAGE_GEOMETRY_BIT;
    }
    vkCmdPushConstants(buffer_, bound_->layout, stages, 0, static_cast<std::uint32_t>(bytes),
                       values);
}

void Commands::dispatch(std::uint32_t groups_x, std::uint32_t groups_y) {
    vkCmdDispatch(buffer_, groups_x, groups_y, 1);
}

void Commands::dispatch_from(std::uint32_t first_x, std::uint32_t first_y, std::uint32_t groups_x,
                             std::uint32_t groups_y) {
    vkCmdDispatchBase(buffer_, first_x, first_y, 0, groups_x, groups_y, 1);
    // Lavapipe (Mesa 22.3) would begin the next indirect dispatch at the same group.
    if (first_x != 0 || first_y != 0) vkCmdDispatch(buffer_, 0, 0, 0);
}

void Commands::dispatch_indirect(VkBuffer buffer, VkDeviceSize offset) {
    vkCmdDispatchIndirect(buffer_, buffer, offset);
}

void Commands::fill(VkBuffer buffer, std::uint32_t value) {
    vkCmdFillBuffer(buffer_, buffer, 0, VK_WHOLE_SIZE, value);
}

void Commands::fill(VkBuffer buffer, std::uint64_t offset, std::uint64_t bytes,
                    std::uint32_t value) {
    vkCmdFillBuffer(buffer_, buffer, offset, bytes, value);
}

void Commands::update(VkBuffer buffer, std::span<const std::uint32_t> words) {
    vkCmdUpdateBuffer(buffer_, buffer, 0, words.size_bytes(), words.data());
}

void Commands::begin_rendering(VkExtent2D extent, std::span<const Target> colors,
                               const Target* depth) {
    const auto attachment = [](const Target& target) {
        return VkRenderingAttachmentInfo{
            .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = target.view,
            .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
            .loadOp = target.clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = target.clear_value};
    };
    std::vector<VkRenderingAttachmentInfo> attachments;
    for (const Target& color : colors) attachments.push_back(attachment(color));
    VkRenderingAttachmentInfo depth_attachment{};
    if (depth != nullptr) depth_attachment = attachment(*depth);
    const VkRenderingInfo rendering{
        .sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
        .renderArea = {{0, 0}, extent},
        .layerCount = 1,
        .colorAttachmentCount = static_cast<std::uint32_t>(attachments.size()),
        .pColorAttachments = attachments.data(),
        .pDepthAttachment = depth != nullptr ? &depth_attachment : nullptr};
    vkCmdBeginRendering(buffer_, &rendering);
    viewport({{0, 0}, extent});
}

void Commands::end_rendering() {
    vkCmdEndRendering(buffer_);
}

void Commands::viewport(VkRect2D rect) {
    const VkViewport port{static_cast<float>(rect.offset.x),
                          static_cast<float>(rect.offset.y),
                          static_cast<float>(rect.extent.width),
                          static_cast<float>(rect.extent.height),
                          0.0f,
                          1.0f};
    vkCmdSetViewport(buffer_, 0, 1, &port);
    vkCmdSetScissor(buffer_, 0, 1, &rect);
}

void Commands::scissor(VkRect2D rect) {
    vkCmdSetScissor(buffer_, 0, 1, &rect);
}

void Commands::draw(std::uint32_t vertices, std::uint32_t instances) {
    vkCmdDraw(buffer_, vertices, instances, 0, 0);
}

void Commands::draw_indirect(VkBuffer buffer, VkDeviceSize offset) {
    vkCmdDrawIndirect(buffer_, buffer, offset, 1, sizeof(VkDrawIndirectCommand));
}

void Commands::draw_indexed(VkBuffer indices, std::uint32_t count) {
    vkCmdBindIndexBuffer(buffer_, indices, 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(buffer_, count, 1, 0, 0, 0);
}

void Commands::vertex_buffers(std::span<const VkBuffer> buffers, std::uint32_t first) {
    constexpr std::array<VkDeviceSize, 8> kFromTheStart{};
    KINO_CHECK_LE(buffers.size(), kFromTheStart.size());
    vkCmdBindVertexBuffers(buffer_, first, static_cast<std::uint32_t>(buffers.size()),
                           buffers.data(), kFromTheStart.data());
}

void Commands::index_buffer(VkBuffer indices) {
    vkCmdBindIndexBuffer(buffer_, indices, 0, VK_INDEX_TYPE_UINT32);
}

void Commands::draw_indexed(const VkDrawIndexedIndirectCommand& call) {
    vkCmdDrawIndexed(buffer_, call.indexCount, call.instanceCount, call.firstIndex,
                     call.vertexOffset, call.firstInstance);
}

void Commands::draw_indexed_indirect(VkBuffer buffer, std::uint32_t draws, VkDeviceSize offset) {
    vkCmdDrawIndexedIndirect(buffer_, buffer, offset, draws, sizeof(VkDrawIndexedIndirectCommand));
}

void Commands::draw_indexed_indirect_count(VkBuffer buffer, VkBuffer count,
                                           std::uint32_t most_draws, VkDeviceSize offset,
                                           VkDeviceSize count_offset) {
    vkCmdDrawIndexedIndirectCount(buffer_, buffer, offset, count, count_offset, most_draws,
                                  sizeof(VkDrawIndexedIndirectCommand));
}

void Commands::change_layout(VkImage image, VkImageLayout from, VkImageLayout to) {
    const VkImageMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {
            .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = 1}};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .imageMemoryBarrierCount = 1,
                                      .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(buffer_, &dependency);
}

void Commands::to_general(VkImage image) {
    change_layout(image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
}

void Commands::to_present(VkImage image) {
    change_layout(image, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}

void Commands::full_barrier() {
    const VkMemoryBarrier2 barrier{
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo dependency{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                      .memoryBarrierCount = 1,
                                      .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(buffer_, &dependency);
}

}  // namespace kino::gpu
