#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "viz/gpu/resource.h"
#include "viz/graph/history.h"
#include "viz/graph/use.h"

namespace kino::graph {

class PassContext;

struct BufferDesc {
    std::uint64_t bytes = 0;
    friend bool operator==(const BufferDesc&, const BufferDesc&) = default;
};

struct TextureDesc {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t samples = 1;
    bool storage = false;          ///< compute shaders write single texels (gpu::Binding::image)
    std::uint32_t room_width = 0;  ///< what memory is made for (FrameGraph::reserve); 0: the size
    std::uint32_t room_height = 0;
    friend bool operator==(const TextureDesc&, const TextureDesc&) = default;
};

/// Names one state of a resource. Writing gives a new id; reading through an older one is a
/// programmer's error found when the pass is declared, so wrong order cannot hide.
struct BufferId {
    std::uint32_t index = UINT32_MAX;
    std::uint32_t version = 0;
    [[nodiscard]] bool valid() const { return index != UINT32_MAX; }
};
struct TextureId {
    std::uint32_t index = UINT32_MAX;
    std::uint32_t version = 0;
    [[nodiscard]] bool valid() const { return index != UINT32_MAX; }
};

struct HistoryPair {
    BufferId previous;
    BufferId current;
    bool valid = false;  ///< previous holds the last frame
};

/// Declares what one pass touches.
class PassBuilder;
using Setup = std::function<void(PassBuilder&)>;
using Execute = std::function<void(PassContext&)>;

struct ResourceUse {
    std::uint32_t resource = 0;
    Use use = Use::compute_read;
};

struct Pass {
    std::string name;   ///< "surface/splat": room or effect first
    std::string group;  ///< what the overlay times together
    std::vector<ResourceUse> uses;
    Execute execute;
    bool side_effect = false;
    bool on_host = false;
};

enum class ResourceKind : std::uint8_t { buffer, texture };

/// A resource as declared; what memory it gets is the compiled graph's business.
struct Resource {
    std::string name;
    ResourceKind kind = ResourceKind::buffer;
    BufferDesc buffer;
    TextureDesc texture;
    std::uint32_t version = 0;
    std::string history_key;  ///< set: memory kept by the executor under this key
    int history_slot = 0;
    const gpu::Buffer* imported_buffer = nullptr;
    VkImage imported_image = VK_NULL_HANDLE;
    VkImageView imported_view = VK_NULL_HANDLE;
    bool imported = false;
};

struct CompiledPass {
    std::uint32_t pass = 0;
    VkPipelineStageFlags2 wait_stages = 0;  ///< one memory barrier for all buffers and images
    VkAccessFlags2 wait_access = 0;
    VkPipelineStageFlags2 stages = 0;
    VkAccessFlags2 access = 0;
    std::vector<std::uint32_t> first_use;  ///< textures that leave UNDEFINED here
    [[nodiscard]] bool has_barrier() const { return stages != 0 || !first_use.empty(); }
};

/// The passes that run, in order, and which transient shares memory with which.
struct CompiledGraph {
    std::vector<CompiledPass> passes;
    /// Resource -> memory slot; UINT32_MAX for imported, history and culled ones.
    std::vector<std::uint32_t> slot_of_resource;
    /// Slot -> one resource that stands for its kind and size.
    std::vector<std::uint32_t> slots;
    std::uint64_t transient_bytes = 0;
};

/// The frame as a list of passes, rebuilt every frame. Declaring costs no device work: passes
/// that lead to nothing required are culled, and transients exist only between first and last
/// use. Tested without a device.
class FrameGraph {
  public:
    /// Starts a frame in the history's books.
    explicit FrameGraph(HistoryBook& history) : history_(history) { history_.begin_frame(); }

    BufferId create_buffer(std::string name, BufferDesc desc);
    TextureId create_texture(std::string name, TextureDesc desc);
    /// The buffer or image must outlive the execution. Imported images are kept in GENERAL by
    /// their owner; `discard` says that the old contents do not matter.
    BufferId import_buffer(std::string name, const gpu::Buffer& buffer);
    BufferId import_buffer(std::string name, BufferDesc desc);  ///< for tests without a device
    TextureId import_texture(std::string name, VkImage image, VkImageView view, TextureDesc desc);
    /// Two buffers under one key that change places every frame (viz/graph/history.h).
    HistoryPair history(const std::string& owner, int view, BufferDesc desc);

    /// Textures created from here on with exactly `size` get memory for `room`, of which they are
    /// the upper left part, so that a size that changes every frame allocates nothing. Whoever
    /// makes buffers for the pixels of a view does so for room(). Neither side below `size`.
    void reserve(VkExtent2D size, VkExtent2D room);
    /// What was reserved for pictures of this size; `size` itself if nothing.
    [[nodiscard]] VkExtent2D room(VkExtent2D size) const;

    /// Runs `setup` at once and keeps `execute` for later.
    void add_pass(std::string name, std::string group, const Setup& setup, Execute execute);

    /// The frame must make this; whatever leads to no required resource is culled.
    void require(BufferId id);
    void require(TextureId id);

    /// Later passes write single texels of this transient, whoever made it.
    void allow_storage(TextureId id);

    [[nodiscard]] CompiledGraph compile() const;
    [[nodiscard]] std::string to_graphviz() const;

    [[nodiscard]] const std::vector<Pass>& passes() const { return passes_; }
    [[nodiscard]] const std::vector<Resource>& resources() const { return resources_; }

  private:
    friend class PassBuilder;
    std::uint32_t add(Resource resource);
    void check_current(std::uint32_t index, std::uint32_t version) const;
    [[nodiscard]] std::vector<bool> living_passes() const;

    HistoryBook& history_;
    std::vector<Resource> resources_;
    std::vector<Pass> passes_;
    std::vector<std::uint32_t> required_;
    struct Reservation {
        VkExtent2D size;
        VkExtent2D room;
    };
    std::vector<Reservation> reservations_;
};

class PassBuilder {
  public:
    BufferId read(BufferId id, Use use);
    TextureId read(TextureId id, Use use);
    /// Returns the id later readers must use; `id` is stale from here on.
    BufferId write(BufferId id, Use use);
    TextureId write(TextureId id, Use use);
    /// Runs even if nobody reads what it makes.
    void side_effect() { pass_.side_effect = true; }
    /// Executes on the host, between two submits: everything declared before it is done then. It
    /// records nothing and touches mapped memory only (host_read, host_write).
    void on_host() { pass_.on_host = true; }

  private:
    friend class FrameGraph;
    PassBuilder(FrameGraph& graph, Pass& pass) : graph_(graph), pass_(pass) {}
    FrameGraph& graph_;
    Pass& pass_;
};

}  // namespace kino::graph
