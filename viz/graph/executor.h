#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viz/gpu/commands.h"
#include "viz/graph/graph.h"

namespace kino::graph {

class Executor;

/// What a pass's execute function gets: commands to record with, and the memory behind ids.
class PassContext {
  public:
    [[nodiscard]] gpu::Commands& commands() { return commands_; }
    /// Makes (at first use) and binds a pipeline with one resource for each binding. False if it
    /// cannot be made; the frame then fails with that error and the pass must return.
    [[nodiscard]] bool bind(const gpu::PipelineDesc& desc, std::span<const gpu::Bound> resources);
    [[nodiscard]] bool bind(const gpu::PipelineDesc& desc,
                            std::initializer_list<gpu::Bound> resources) {
        return bind(desc, std::span(resources.begin(), resources.size()));
    }
    [[nodiscard]] gpu::Bound bound(BufferId id) const;
    [[nodiscard]] gpu::Bound bound(TextureId id, bool linear = false) const;
    [[nodiscard]] VkBuffer buffer(BufferId id) const { return bound(id).buffer; }
    [[nodiscard]] VkImageView view(TextureId id) const { return bound(id).view; }
    [[nodiscard]] VkImage image(TextureId id) const;
    [[nodiscard]] TextureDesc desc(TextureId id) const;
    /// Small per-frame data (matrices, lights) as a storage buffer that lives for this frame.
    [[nodiscard]] gpu::Bound upload(const void* data, std::size_t bytes);
    template <class T>
    [[nodiscard]] gpu::Bound upload(const std::vector<T>& values) {
        return upload(values.data(), values.size() * sizeof(T));
    }

  private:
    friend class Executor;
    PassContext(Executor& executor, const FrameGraph& graph, gpu::Commands commands)
        : executor_(executor), graph_(graph), commands_(commands) {}
    Executor& executor_;
    const FrameGraph& graph_;
    gpu::Commands commands_;
};

struct GroupTime {
    std::string group;
    double ms = 0;  ///< newest measurement
};

/// What one executed frame was made of.
struct FrameReport {
    std::vector<std::string> passes;  ///< names, in order
    /// Runs of passes of one group, in order; ms below 0: not measured on its own in this frame.
    std::vector<GroupTime> groups;
    std::uint64_t transient_bytes = 0;
    std::uint64_t history_bytes = 0;
    /// True frame time of the device, all parts summed, passes on the host among them.
    TimeNs submit_to_fence = 0;
};

enum class Timing : std::uint8_t {
    frame,        ///< one submit: only the whole is known
    one_group,    ///< one group a frame, in turn, gets a submit and fence of its own
    every_group,  ///< all do; for benches and for the test that sums the parts
    every_pass    ///< each pass on its own, named as a group of its own; for tuning
};

/// Gives a FrameGraph memory and runs it. On CPU devices timestamps read near zero for
/// buffer-only compute, so time is measured from submit to fence (renderer notes 2.5).
class Executor {
  public:
    Executor(gpu::Device& device, gpu::Pipelines& pipelines);
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    [[nodiscard]] HistoryBook& history() { return history_; }

    /// Records, submits and waits.
    [[nodiscard]] Result<FrameReport> run(const FrameGraph& graph, Timing timing);

    /// Newest measured time of each group of the last frame, in frame order.
    [[nodiscard]] const std::vector<GroupTime>& group_times() const { return group_times_; }

    /// Frees pooled memory that the last `frames` frames did not use.
    void set_pool_age(int frames) { pool_age_ = frames; }

    /// For tests: before every frame all transient memory but depth targets is filled with what is
    /// no number, so that a pass that reads what no pass wrote shows.
    void set_poison(bool poisons) { poisons_ = poisons; }

  private:
    friend class PassContext;
    struct PooledBuffer {
        gpu::Buffer buffer;
        int unused_frames = 0;
        bool taken = false;
    };
    struct PooledTexture {
        gpu::Texture texture;
        int unused_frames = 0;
        bool taken = false;
    };

    Result<void> place(const FrameGraph& graph, const CompiledGraph& compiled);
    Result<void> place_history(const FrameGraph& graph);
    Result<void> poison();
    Result<const gpu::Buffer*> pooled_buffer(const std::string& name, std::uint64_t bytes);
    Result<const gpu::Texture*> pooled_texture(const std::string& name, const TextureDesc& desc);
    /// Passes [first, last) of the compiled graph, waited for.
    Result<TimeNs> run_passes(const FrameGraph& graph, const CompiledGraph& compiled,
                              std::size_t first, std::size_t last, FrameReport& report);
    void record_barrier(VkCommandBuffer commands, const FrameGraph& graph,
                        const CompiledPass& pass) const;
    void age_pool();

    gpu::Device& device_;
    gpu::Pipelines& pipelines_;
    HistoryBook history_;
    std::map<std::string, gpu::Buffer> history_memory_;
    std::vector<std::unique_ptr<PooledBuffer>> buffers_;
    std::vector<std::unique_ptr<PooledTexture>> textures_;
    std::vector<const gpu::Buffer*> buffer_of_resource_;
    std::vector<const gpu::Texture*> texture_of_resource_;
    gpu::Buffer upload_;
    std::uint64_t upload_used_ = 0;
    std::vector<GroupTime> group_times_;
    std::size_t next_timed_group_ = 0;
    int pool_age_ = 30;
    bool poisons_ = false;
    std::optional<Error> error_;
};

}  // namespace kino::graph
