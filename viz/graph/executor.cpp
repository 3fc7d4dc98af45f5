#include "viz/graph/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "base/check.h"

namespace kino::graph {
namespace {
constexpr std::uint64_t kUploadBytes = 1 << 20;

/// No number, or what else nobody wants to read.
VkClearColorValue poison_of(VkFormat format) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    switch (format) {
        case VK_FORMAT_R32_SFLOAT:
        case VK_FORMAT_R16G16B16A16_SFLOAT:
        case VK_FORMAT_R32G32B32A32_SFLOAT:
            return {.float32 = {kNaN, kNaN, kNaN, kNaN}};
        case VK_FORMAT_R32_UINT:
        case VK_FORMAT_R32G32_UINT:
            return {.uint32 = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX}};
        default:
            return {.float32 = {1, 1, 1, 1}};
    }
}
}  // namespace

bool PassContext::bind(const gpu::PipelineDesc& desc, std::span<const gpu::Bound> resources) {
    if (executor_.error_) return false;
    auto pipeline = executor_.pipelines_.get(desc);
    if (!pipeline) {
        executor_.error_ = pipeline.error();
        return false;
    }
    commands_.bind(**pipeline, resources);
    return true;
}

gpu::Bound PassContext::bound(BufferId id) const {
    const gpu::Buffer* buffer = executor_.buffer_of_resource_[id.index];
    KINO_CHECK(buffer != nullptr);  // else the pass did not declare it
    return {.buffer = buffer->handle(),
            .bytes = graph_.resources()[id.index].buffer.bytes,
            .words = buffer->words(),
            .word_pairs = buffer->word_pairs(),
            .word_quads = buffer->word_quads()};
}

gpu::Bound PassContext::bound(TextureId id, bool linear) const {
    const Resource& resource = graph_.resources()[id.index];
    if (resource.imported) return {.view = resource.imported_view, .linear = linear};
    KINO_CHECK(executor_.texture_of_resource_[id.index] != nullptr);
    return {.view = executor_.texture_of_resource_[id.index]->view(), .linear = linear};
}

VkImage PassContext::image(TextureId id) const {
    const Resource& resource = graph_.resources()[id.index];
    return resource.imported ? resource.imported_image
                             : executor_.texture_of_resource_[id.index]->image();
}

TextureDesc PassContext::desc(TextureId id) const {
    return graph_.resources()[id.index].texture;
}

gpu::Bound PassContext::upload(const void* data, std::size_t bytes) {
    const VkDeviceSize alignment = executor_.device_.info().storage_alignment;
    const std::uint64_t offset = (executor_.upload_used_ + alignment - 1) / alignment * alignment;
    // Per-frame data is small and bounded by the scene checks; more is a programmer's error.
    KINO_CHECK_LE(offset + bytes, kUploadBytes);
    executor_.upload_.write(std::span(static_cast<const char*>(data), bytes), offset);
    executor_.upload_used_ = offset + bytes;
    return {.buffer = executor_.upload_.handle(), .offset = offset, .bytes = bytes};
}

Executor::Executor(gpu::Device& device, gpu::Pipelines& pipelines)
    : device_(device), pipelines_(pipelines) {}

Executor::~Executor() {
    device_.wait_idle();
}

Result<const gpu::Buffer*> Executor::pooled_buffer(const std::string& name, std::uint64_t bytes) {
    for (auto& pooled : buffers_) {
        if (!pooled->taken && pooled->buffer.bytes() == bytes) {
            pooled->taken = true;
            return &pooled->buffer;
        }
    }
    auto pooled = std::make_unique<PooledBuffer>();
    KINO_ASSIGN(pooled->buffer, gpu::Buffer::create(device_, name, bytes, gpu::MemoryUse::device));
    pooled->taken = true;
    buffers_.push_back(std::move(pooled));
    return &buffers_.back()->buffer;
}

Result<const gpu::Texture*> Executor::pooled_texture(const std::string& name,
                                                     const TextureDesc& desc) {
    for (auto& pooled : textures_) {
        const gpu::Texture& texture = pooled->texture;
        if (!pooled->taken && texture.extent().width == desc.room_width &&
            texture.extent().height == desc.room_height && texture.format() == desc.format &&
            texture.samples() == desc.samples && texture.storage() == desc.storage) {
            pooled->taken = true;
            return &pooled->texture;
        }
    }
    auto pooled = std::make_unique<PooledTexture>();
    KINO_ASSIGN(pooled->texture,
                gpu::Texture::create(device_, name, {desc.room_width, desc.room_height},
                                     desc.format, desc.samples, desc.storage));
    pooled->taken = true;
    textures_.push_back(std::move(pooled));
    return &textures_.back()->texture;
}

Result<void> Executor::place(const FrameGraph& graph, const CompiledGraph& compiled) {
    for (auto& pooled : buffers_) pooled->taken = false;
    for (auto& pooled : textures_) pooled->taken = false;
    const std::vector<Resource>& resources = graph.resources();
    buffer_of_resource_.assign(resources.size(), nullptr);
    texture_of_resource_.assign(resources.size(), nullptr);
    std::vector<const gpu::Buffer*> slot_buffer(compiled.slots.size(), nullptr);
    std::vector<const gpu::Texture*> slot_texture(compiled.slots.size(), nullptr);
    for (std::size_t slot = 0; slot < compiled.slots.size(); ++slot) {
        const Resource& resource = resources[compiled.slots[slot]];
        if (resource.kind == ResourceKind::buffer) {
            KINO_ASSIGN(slot_buffer[slot], pooled_buffer(resource.name, resource.buffer.bytes));
        } else {
            KINO_ASSIGN(slot_texture[slot], pooled_texture(resource.name, resource.texture));
        }
    }
    for (std::size_t r = 0; r < resources.size(); ++r) {
        if (resources[r].imported) {
            buffer_of_resource_[r] = resources[r].imported_buffer;
        } else if (const std::uint32_t slot = compiled.slot_of_resource[r]; slot != UINT32_MAX) {
            buffer_of_resource_[r] = slot_buffer[slot];
            texture_of_resource_[r] = slot_texture[slot];
        }
    }
    return {};
}

Result<void> Executor::poison() {
    KINO_TRY(device_.submit_and_wait([&](VkCommandBuffer buffer) {
        gpu::Commands commands(device_, buffer);
        for (const auto& pooled : buffers_) commands.fill(pooled->buffer.handle(), UINT32_MAX);
        for (const auto& pooled : textures_) {
            const gpu::Texture& texture = pooled->texture;
            if (gpu::is_depth_format(texture.format())) continue;
            commands.to_general(texture.image());
            const VkImageSubresourceRange all{
                .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = 1};
            const VkClearColorValue value = poison_of(texture.format());
            vkCmdClearColorImage(buffer, texture.image(), VK_IMAGE_LAYOUT_GENERAL, &value, 1, &all);
        }
        commands.full_barrier();
    }));
    return {};
}

Result<void> Executor::place_history(const FrameGraph& graph) {
    const std::vector<Resource>& resources = graph.resources();
    for (std::size_t r = 0; r < resources.size(); ++r) {
        const Resource& resource = resources[r];
        if (resource.history_key.empty()) continue;
        gpu::Buffer& memory =
            history_memory_[fmt::format("{}#{}", resource.history_key, resource.history_slot)];
        if (memory.bytes() != resource.buffer.bytes) {
            memory = gpu::Buffer();
            KINO_ASSIGN(memory, gpu::Buffer::create(device_, resource.name, resource.buffer.bytes,
                                                    gpu::MemoryUse::device));
        }
        buffer_of_resource_[r] = &memory;
    }
    // What the books no longer hold gives its memory back.
    std::erase_if(history_memory_, [&](const auto& item) {
        return std::none_of(resources.begin(), resources.end(), [&](const Resource& resource) {
            return !resource.history_key.empty() &&
                   item.first.compare(0, item.first.rfind('#'), resource.history_key) == 0;
        });
    });
    return {};
}

void Executor::record_barrier(VkCommandBuffer commands, const FrameGraph& graph,
                              const CompiledPass& pass) const {
    if (!pass.has_barrier()) return;
    const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                  .srcStageMask = pass.wait_stages,
                                  .srcAccessMask = pass.wait_access,
                                  .dstStageMask = pass.stages,
                                  .dstAccessMask = pass.access};
    std::vector<VkImageMemoryBarrier2> images;
    for (const std::uint32_t resource : pass.first_use) {
        const bool depth = gpu::is_depth_format(graph.resources()[resource].texture.format);
        images.push_back(
            {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
             .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
             .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
             .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
             .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
             .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
             .newLayout = VK_IMAGE_LAYOUT_GENERAL,
             .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
             .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
             .image = texture_of_resource_[resource]->image(),
             .subresourceRange = {
                 .aspectMask = static_cast<VkImageAspectFlags>(depth ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                                     : VK_IMAGE_ASPECT_COLOR_BIT),
                 .levelCount = 1,
                 .layerCount = 1}});
    }
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = pass.stages != 0 ? 1u : 0u,
        .pMemoryBarriers = &memory,
        .imageMemoryBarrierCount = static_cast<std::uint32_t>(images.size()),
        .pImageMemoryBarriers = images.data()};
    vkCmdPipelineBarrier2(commands, &dependency);
}

Result<TimeNs> Executor::run_passes(const FrameGraph& graph, const CompiledGraph& compiled,
                                    std::size_t first, std::size_t last, FrameReport& report) {
    TimeNs elapsed = 0;
    const auto execute = [&](const CompiledPass& compiled_pass, VkCommandBuffer buffer) {
        const Pass& pass = graph.passes()[compiled_pass.pass];
        PassContext context(*this, graph, gpu::Commands(device_, buffer));
        pass.execute(context);
        report.passes.push_back(pass.name);
    };
    while (first < last) {
        const CompiledPass& pass = compiled.passes[first];
        if (graph.passes()[pass.pass].on_host) {
            KINO_CHECK(pass.first_use.empty());  // has no commands to touch a texture with
            const TimeNs start = now_ns();
            execute(pass, VK_NULL_HANDLE);
            elapsed += now_ns() - start;
            ++first;
        } else {
            KINO_ASSIGN(
                const TimeNs submitted, device_.submit_and_wait([&](VkCommandBuffer buffer) {
                    for (; first < last && !graph.passes()[compiled.passes[first].pass].on_host;
                         ++first) {
                        if (error_) continue;
                        record_barrier(buffer, graph, compiled.passes[first]);
                        execute(compiled.passes[first], buffer);
                    }
                    // Host reads of mapped memory follow the fence.
                    gpu::Commands(device_, buffer).full_barrier();
                }));
            elapsed += submitted;
        }
        if (error_) return fail(*error_);
    }
    return elapsed;
}

Result<FrameReport> Executor::run(const FrameGraph& graph, Timing timing) {
    const CompiledGraph compiled = graph.compile();
    if (upload_.empty()) {
        KINO_ASSIGN(upload_, gpu::Buffer::create(device_, "frame upload", kUploadBytes,
                                                 gpu::MemoryUse::upload));
    }
    upload_used_ = 0;
    error_.reset();
    KINO_TRY(place(graph, compiled));
    KINO_TRY(place_history(graph));
    if (poisons_) KINO_TRY(poison());

    const auto label = [&](const CompiledPass& pass) -> const std::string& {
        const Pass& declared = graph.passes()[pass.pass];
        return timing == Timing::every_pass ? declared.name : declared.group;
    };
    std::vector<std::string> groups;
    for (const CompiledPass& pass : compiled.passes) {
        const std::string& group = label(pass);
        if (groups.empty() || groups.back() != group) groups.push_back(group);
    }
    std::vector<GroupTime> times;
    for (const std::string& group : groups) {
        const auto known = std::find_if(group_times_.begin(), group_times_.end(),
                                        [&](const GroupTime& t) { return t.group == group; });
        times.push_back({group, known == group_times_.end() ? 0.0 : known->ms});
    }
    group_times_ = std::move(times);
    const std::size_t timed = groups.empty() ? 0 : next_timed_group_++ % groups.size();

    FrameReport report;
    for (const std::string& group : groups) report.groups.push_back({group, -1});
    report.transient_bytes = compiled.transient_bytes;
    report.history_bytes = history_.total_bytes();
    // Consecutive passes go into one submit until a group's time is wanted.
    std::size_t next = 0;
    std::size_t group_index = 0;
    while (next < compiled.passes.size()) {
        std::size_t end = next;
        std::size_t end_group = group_index;
        const auto split_at = [&](std::size_t group) {
            return timing == Timing::every_group || timing == Timing::every_pass ||
                   (timing == Timing::one_group && (group == timed || group == timed + 1));
        };
        do {
            const std::string& group = label(compiled.passes[end]);
            while (end < compiled.passes.size() && label(compiled.passes[end]) == group) {
                ++end;
            }
            ++end_group;
        } while (end < compiled.passes.size() && !split_at(end_group));
        KINO_ASSIGN(const TimeNs elapsed, run_passes(graph, compiled, next, end, report));
        report.submit_to_fence += elapsed;
        const bool single = end_group == group_index + 1;
        if (single && (timing == Timing::every_group || timing == Timing::every_pass ||
                       (timing == Timing::one_group && group_index == timed))) {
            group_times_[group_index].ms = to_ms(elapsed);
            report.groups[group_index].ms = to_ms(elapsed);
        }
        next = end;
        group_index = end_group;
    }
    age_pool();
    return report;
}

void Executor::age_pool() {
    const auto age = [&](auto& pool) {
        for (auto& pooled : pool)
            pooled->unused_frames = pooled->taken ? 0 : pooled->unused_frames + 1;
        std::erase_if(pool, [&](const auto& pooled) { return pooled->unused_frames > pool_age_; });
    };
    age(buffers_);
    age(textures_);
}

}  // namespace kino::graph
