#include "viz/gpu/pipeline.h"

#include <fmt/format.h>

#include <array>
#include <set>

#include "base/check.h"

namespace kino::gpu {
namespace {

std::string key_of(const PipelineDesc& desc) {
    std::string key = desc.name;
    for (const VkFormat format : desc.color_formats) key += fmt::format("|{}", int(format));
    key += fmt::format("|{}|{}", int(desc.depth_format), int(desc.blend));
    key += fmt::format("|{}|{}", int(desc.depth_test), desc.samples);
    for (const VertexStream& stream : desc.streams) {
        key += fmt::format("|{}{}", stream.per_instance ? "i" : "v", stream.stride);
        for (const VertexStream::Attribute& attribute : stream.attributes) {
            key += fmt::format(",{}@{}", int(attribute.format), attribute.offset);
        }
    }
    for (const std::uint32_t constant : desc.constants) key += fmt::format(":{}", constant);
    return key;
}

Result<VkShaderModule> make_module(Device& device, std::span<const std::uint32_t> code,
                                   const std::string& name) {
    const VkShaderModuleCreateInfo create{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                          .codeSize = code.size_bytes(),
                                          .pCode = code.data()};
    VkShaderModule shader = VK_NULL_HANDLE;
    KINO_VK_TRY(vkCreateShaderModule(device.handle(), &create, nullptr, &shader),
                "loading shader " + name);
    return shader;
}

/// Shader modules live only while the pipeline is made.
struct Stages {
    explicit Stages(Device& d) : device(d) {}
    ~Stages() {
        for (const auto& stage : infos)
            vkDestroyShaderModule(device.handle(), stage.module, nullptr);
    }
    Stages(const Stages&) = delete;
    Stages& operator=(const Stages&) = delete;

    Result<void> add(VkShaderStageFlagBits stage, std::span<const std::uint32_t> code,
                     const PipelineDesc& desc) {
        if (code.empty()) return {};
        KINO_ASSIGN(const VkShaderModule shader, make_module(device, code, desc.name));
        infos.push_back({.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                         .stage = stage,
                         .module = shader,
                         .pName = "main",
                         .pSpecializationInfo = &specialisation});
        return {};
    }

    Device& device;
    VkSpecializationInfo specialisation{};
    std::vector<VkPipelineShaderStageCreateInfo> infos;
};

VkPipelineColorBlendAttachmentState blend_state(Blend blend) {
    VkPipelineColorBlendAttachmentState state{
        .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
        .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .colorBlendOp = VK_BLEND_OP_ADD,
        .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
        .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
        .alphaBlendOp = VK_BLEND_OP_ADD,
        .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                          VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT};
    state.blendEnable = blend != Blend::none;
    if (blend == Blend::additive) state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE;
    return state;
}

VkCompareOp compare_op(DepthTest test) {
    switch (test) {
        case DepthTest::nearer_writes:
            return VK_COMPARE_OP_GREATER;
        case DepthTest::not_farther_writes:
        case DepthTest::not_farther:
            return VK_COMPARE_OP_GREATER_OR_EQUAL;
        case DepthTest::equal:
            return VK_COMPARE_OP_EQUAL;
        case DepthTest::any_writes:
            break;
    }
    return VK_COMPARE_OP_ALWAYS;
}

Result<VkPipeline> make_graphics(Device& device, const PipelineDesc& desc, const Stages& stages,
                                 VkPipelineLayout layout) {
    // position (2 floats), texture coordinate (2 floats), colour (4 bytes): Dear ImGui's vertex.
    constexpr VkVertexInputBindingDescription kVertex{
        .binding = 0, .stride = 20, .inputRate = VK_VERTEX_INPUT_RATE_VERTEX};
    constexpr std::array<VkVertexInputAttributeDescription, 3> kAttributes = {{
        {.location = 0, .binding = 0, .format = VK_FORMAT_R32G32_SFLOAT, .offset = 0},
        {.location = 1, .binding = 0, .format = VK_FORMAT_R32G32_SFLOAT, .offset = 8},
        {.location = 2, .binding = 0, .format = VK_FORMAT_R8G8B8A8_UNORM, .offset = 16},
    }};
    KINO_CHECK(!desc.vertex_colors || desc.streams.empty());
    std::vector<VkVertexInputBindingDescription> streams;
    std::vector<VkVertexInputAttributeDescription> attributes;
    if (desc.vertex_colors) {
        streams = {kVertex};
        attributes.assign(kAttributes.begin(), kAttributes.end());
    }
    for (const VertexStream& stream : desc.streams) {
        const auto binding = static_cast<std::uint32_t>(streams.size());
        streams.push_back({.binding = binding,
                           .stride = stream.stride,
                           .inputRate = stream.per_instance ? VK_VERTEX_INPUT_RATE_INSTANCE
                                                            : VK_VERTEX_INPUT_RATE_VERTEX});
        for (const VertexStream::Attribute& attribute : stream.attributes) {
            attributes.push_back({.location = static_cast<std::uint32_t>(attributes.size()),
                                  .binding = binding,
                                  .format = attribute.format,
                                  .offset = attribute.offset});
        }
    }
    const VkPipelineVertexInputStateCreateInfo input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = static_cast<std::uint32_t>(streams.size()),
        .pVertexBindingDescriptions = streams.data(),
        .vertexAttributeDescriptionCount = static_cast<std::uint32_t>(attributes.size()),
        .pVertexAttributeDescriptions = attributes.data()};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = desc.topology};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = VK_CULL_MODE_NONE,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
        .lineWidth = 1.0f};
    const VkPipelineMultisampleStateCreateInfo samples{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = static_cast<VkSampleCountFlagBits>(desc.samples)};
    const bool has_depth = desc.depth_format != VK_FORMAT_UNDEFINED;
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = has_depth,
        .depthWriteEnable = has_depth && desc.depth_test != DepthTest::not_farther &&
                            desc.depth_test != DepthTest::equal,
        .depthCompareOp = compare_op(desc.depth_test)};
    const std::vector<VkPipelineColorBlendAttachmentState> blends(desc.color_formats.size(),
                                                                  blend_state(desc.blend));
    const VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = static_cast<std::uint32_t>(blends.size()),
        .pAttachments = blends.data()};
    constexpr std::array<VkDynamicState, 2> kDynamic = {VK_DYNAMIC_STATE_VIEWPORT,
                                                        VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = kDynamic.size(),
        .pDynamicStates = kDynamic.data()};
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = static_cast<std::uint32_t>(desc.color_formats.size()),
        .pColorAttachmentFormats = desc.color_formats.data(),
        .depthAttachmentFormat = desc.depth_format};
    const VkGraphicsPipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = static_cast<std::uint32_t>(stages.infos.size()),
        .pStages = stages.infos.data(),
        .pVertexInputState = &input,
        .pInputAssemblyState = &assembly,
        .pViewportState = &viewport,
        .pRasterizationState = &raster,
        .pMultisampleState = &samples,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = layout};
    VkPipeline pipeline = VK_NULL_HANDLE;
    KINO_VK_TRY(vkCreateGraphicsPipelines(device.handle(), device.pipeline_cache(), 1, &create,
                                          nullptr, &pipeline),
                "creating pipeline " + desc.name);
    return pipeline;
}

}  // namespace

VkDescriptorType descriptor_type(Binding binding) {
    switch (binding) {
        case Binding::storage:
            return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case Binding::texture:
            return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        case Binding::image:
            return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        case Binding::words:
        case Binding::word_pairs:
        case Binding::word_quads:
            break;
    }
    return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

Pipelines::~Pipelines() {
    for (auto& [key, pipeline] : made_) {
        vkDestroyPipeline(device_.handle(), pipeline->handle, nullptr);
        vkDestroyPipelineLayout(device_.handle(), pipeline->layout, nullptr);
        vkDestroyDescriptorSetLayout(device_.handle(), pipeline->set_layout, nullptr);
    }
}

Result<const Pipeline*> Pipelines::get(const PipelineDesc& desc) {
    std::string key = key_of(desc);
    if (const auto found = made_.find(key); found != made_.end()) return found->second.get();
    KINO_ASSIGN(auto pipeline, create(desc));
    return made_.emplace(std::move(key), std::move(pipeline)).first->second.get();
}

std::vector<std::string> Pipelines::names() const {
    std::set<std::string> names;
    for (const auto& [key, pipeline] : made_) names.insert(key.substr(0, key.find('|')));
    return {names.begin(), names.end()};
}

Result<std::unique_ptr<Pipeline>> Pipelines::create(const PipelineDesc& desc) {
    KINO_CHECK_LE(desc.push_bytes, 128u);
    const bool compute = !desc.compute.empty();
    const VkShaderStageFlags stages_flags =
        compute ? VkShaderStageFlags{VK_SHADER_STAGE_COMPUTE_BIT}
                : VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT |
                      static_cast<VkShaderStageFlags>(
                          desc.geometry.empty() ? 0 : VK_SHADER_STAGE_GEOMETRY_BIT);
    auto pipeline = std::make_unique<Pipeline>();
    pipeline->bindings = desc.bindings;
    pipeline->push_bytes = desc.push_bytes;
    pipeline->has_geometry = !desc.geometry.empty();
    pipeline->bind_point =
        compute ? VK_PIPELINE_BIND_POINT_COMPUTE : VK_PIPELINE_BIND_POINT_GRAPHICS;

    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < desc.bindings.size(); ++i) {
        bindings.push_back({.binding = i,
                            .descriptorType = descriptor_type(desc.bindings[i]),
                            .descriptorCount = 1,
                            .stageFlags = stages_flags});
    }
    const VkDescriptorSetLayoutCreateInfo set_layout{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR,
        .bindingCount = static_cast<std::uint32_t>(bindings.size()),
        .pBindings = bindings.data()};
    KINO_VK_TRY(
        vkCreateDescriptorSetLayout(device_.handle(), &set_layout, nullptr, &pipeline->set_layout),
        "laying out " + desc.name);
    const VkPushConstantRange range{.stageFlags = stages_flags, .size = desc.push_bytes};
    const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = 1,
                                            .pSetLayouts = &pipeline->set_layout,
                                            .pushConstantRangeCount = desc.push_bytes > 0 ? 1u : 0u,
                                            .pPushConstantRanges = &range};
    KINO_VK_TRY(vkCreatePipelineLayout(device_.handle(), &layout, nullptr, &pipeline->layout),
                "laying out " + desc.name);

    Stages stages(device_);
    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < desc.constants.size(); ++i) entries.push_back({i, 4 * i, 4});
    stages.specialisation = {.mapEntryCount = static_cast<std::uint32_t>(entries.size()),
                             .pMapEntries = entries.data(),
                             .dataSize = desc.constants.size() * sizeof(std::uint32_t),
                             .pData = desc.constants.data()};
    KINO_TRY(stages.add(VK_SHADER_STAGE_COMPUTE_BIT, desc.compute, desc));
    KINO_TRY(stages.add(VK_SHADER_STAGE_VERTEX_BIT, desc.vertex, desc));
    KINO_TRY(stages.add(VK_SHADER_STAGE_GEOMETRY_BIT, desc.geometry, desc));
    KINO_TRY(stages.add(VK_SHADER_STAGE_FRAGMENT_BIT, desc.fragment, desc));
    if (compute) {
        const VkComputePipelineCreateInfo create{
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .flags = VK_PIPELINE_CREATE_DISPATCH_BASE_BIT,
            .stage = stages.infos.front(),
            .layout = pipeline->layout};
        KINO_VK_TRY(vkCreateComputePipelines(device_.handle(), device_.pipeline_cache(), 1, &create,
                                             nullptr, &pipeline->handle),
                    "creating pipeline " + desc.name);
    } else {
        KINO_ASSIGN(pipeline->handle, make_graphics(device_, desc, stages, pipeline->layout));
    }
    return pipeline;
}

}  // namespace kino::gpu
