#pragma once

#include <cstdint>
#include <span>

#include "base/error.h"
#include "viz/accel/bvh.h"
#include "viz/accel/traverse.h"
#include "viz/graph/executor.h"
#include "viz/graph/graph.h"

namespace kino {

/// A tree as passes see it (viz/accel/bvh.glsl reads it as word_quads).
struct BvhBuffers {
    graph::BufferId nodes;      ///< shared::BvhNode, 2^levels of them
    graph::BufferId triangles;  ///< shared::BvhTriangle
    int levels = 0;             ///< 0: nothing in it, and the ids are invalid
    std::uint32_t triangle_count = 0;

    [[nodiscard]] bool empty() const { return levels == 0; }
};

/// A tree in device memory that outlives frames. Bound to one device, which must outlive it.
class DeviceBvh {
  public:
    explicit DeviceBvh(gpu::Device& device) : device_(device) {}

    /// A tree that was built on the host.
    [[nodiscard]] Result<void> upload(const Bvh& bvh);
    /// Makes room for a tree over these triangles, which have no faults, and copies them:
    /// add_build() makes the tree of them. As many as before: add_refit() may, too.
    [[nodiscard]] Result<void> upload_soup(std::span<const Triangle> triangles,
                                           const BvhOptions& options);

    /// The tree as it is.
    [[nodiscard]] BvhBuffers add(graph::FrameGraph& graph) const;
    /// Adds the passes that build the tree from the soup.
    [[nodiscard]] BvhBuffers add_build(graph::FrameGraph& graph) const;
    /// Adds the passes that move the tree's triangles to where the soup has them, and fit the
    /// boxes.
    [[nodiscard]] BvhBuffers add_refit(graph::FrameGraph& graph) const;

    /// Lanes that share the sort: few on a processor, whose lanes are not many.
    std::uint32_t sort_lanes = 128;

    [[nodiscard]] std::uint64_t bytes() const;
    void clear();

  private:
    [[nodiscard]] shared::BuildParams params() const;
    void add_boxes(graph::FrameGraph& graph, BvhBuffers& bvh) const;
    Result<void> make_room(std::size_t triangles, int levels);

    gpu::Device& device_;
    gpu::Buffer soup_;
    gpu::Buffer nodes_;
    gpu::Buffer triangles_;
    BvhOptions options_;
    int levels_ = 0;
    std::uint32_t count_ = 0;
};

/// Traces rays that lie in `rays` (shared::TraceRay) and returns a buffer of shared::TraceHit; with
/// `any`, a hit's triangle is 0 and nothing else is set. The tree must not be empty.
[[nodiscard]] graph::BufferId add_trace(graph::FrameGraph& graph, const BvhBuffers& bvh,
                                        graph::BufferId rays, std::uint32_t count, bool any);

}  // namespace kino
