#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "viz/gpu/device.h"
#include "viz/gpu/resource.h"

namespace kino::gpu {

/// Kinds of shader resources; binding i of set 0 has kind `bindings[i]`.
enum class Binding : std::uint8_t {
    storage,
    texture,
    // Buffers that a shader only reads, a uint or a uvec2 at a time, by texelFetch of a
    // usamplerBuffer: on lavapipe one vector gather for all lanes, where a storage buffer costs
    // each lane a branch and a load.
    words,
    word_pairs,
    word_quads,  ///< a uvec4 at a time
    image        ///< a texture made with `storage`, written texel by texel
};
[[nodiscard]] VkDescriptorType descriptor_type(Binding binding);

enum class Blend : std::uint8_t { none, alpha, additive };

/// What happens at the depth target, if there is one. Depths are reversed: nearer is greater.
enum class DepthTest : std::uint8_t {
    nearer_writes,       ///< strictly nearer, and writes
    not_farther_writes,  ///< nearer or equal, and writes
    not_farther,         ///< nearer or equal, writes nothing: blended surfaces
    equal,               ///< what a prepass with the same vertex shader left, writes nothing
    any_writes           ///< always writes: seeds
};

/// A vertex buffer: attributes of consecutive locations from one buffer, in the order of `streams`.
struct VertexStream {
    struct Attribute {
        VkFormat format = VK_FORMAT_UNDEFINED;
        std::uint32_t offset = 0;  ///< bytes
        friend bool operator==(const Attribute&, const Attribute&) = default;
    };
    std::uint32_t stride = 0;  ///< bytes
    bool per_instance = false;
    std::vector<Attribute> attributes;
};

/// A pipeline as plain data. `name` says who owns it: "surface/splat"; asking for the same name,
/// formats and constants again gives the same pipeline.
struct PipelineDesc {
    std::string name;
    std::span<const std::uint32_t> compute;  ///< a compute pipeline has only this
    std::span<const std::uint32_t> vertex;
    std::span<const std::uint32_t> geometry;
    std::span<const std::uint32_t> fragment;
    std::vector<Binding> bindings;
    std::uint32_t push_bytes = 0;          ///< at most 128
    std::vector<std::uint32_t> constants;  ///< specialisation constants 0, 1, ...
    VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    std::vector<VkFormat> color_formats;
    VkFormat depth_format = VK_FORMAT_UNDEFINED;  ///< set: reversed-Z test and write
    DepthTest depth_test = DepthTest::nearer_writes;
    std::uint32_t samples = 1;  ///< of all targets
    Blend blend = Blend::none;
    std::vector<VertexStream> streams;  ///< vertex buffers by binding; empty: the shader pulls
    bool vertex_colors = false;         ///< ImGui's vertex layout (position, uv, packed colour)
};

struct Pipeline {
    VkPipeline handle = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_COMPUTE;
    bool has_geometry = false;
    std::vector<Binding> bindings;
    std::uint32_t push_bytes = 0;
};

/// Makes pipelines at first use and keeps them. The names made so far show what a scene cost.
class Pipelines {
  public:
    explicit Pipelines(Device& device) : device_(device) {}
    ~Pipelines();
    Pipelines(const Pipelines&) = delete;
    Pipelines& operator=(const Pipelines&) = delete;

    [[nodiscard]] Result<const Pipeline*> get(const PipelineDesc& desc);
    /// Names of pipelines that exist now, each once, sorted.
    [[nodiscard]] std::vector<std::string> names() const;

  private:
    Result<std::unique_ptr<Pipeline>> create(const PipelineDesc& desc);

    Device& device_;
    std::map<std::string, std::unique_ptr<Pipeline>> made_;
};

}  // namespace kino::gpu
