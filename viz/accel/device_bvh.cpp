#include "viz/accel/device_bvh.h"

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::BufferId;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;
using shared::BuildParams;

constexpr std::uint32_t kBox[] = {
#include "accel_box_comp.inc"
};
constexpr std::uint32_t kFrame[] = {
#include "accel_frame_comp.inc"
};
constexpr std::uint32_t kCodes[] = {
#include "accel_codes_comp.inc"
};
constexpr std::uint32_t kSortCount[] = {
#include "accel_sort_count_comp.inc"
};
constexpr std::uint32_t kSortTotals[] = {
#include "accel_sort_totals_comp.inc"
};
constexpr std::uint32_t kSortOffsets[] = {
#include "accel_sort_offsets_comp.inc"
};
constexpr std::uint32_t kSortScatter[] = {
#include "accel_sort_scatter_comp.inc"
};
constexpr std::uint32_t kOrder[] = {
#include "accel_order_comp.inc"
};
constexpr std::uint32_t kNodes[] = {
#include "accel_nodes_comp.inc"
};
constexpr std::uint32_t kBoxes[] = {
#include "accel_boxes_comp.inc"
};
constexpr std::uint32_t kTrace[] = {
#include "accel_trace_comp.inc"
};

constexpr const char* kBuildGroup = "accel build";

void dispatch_groups(PassContext& c, std::uint64_t items, std::uint32_t group) {
    const std::uint64_t groups = (items + group - 1) / group;
    constexpr std::uint64_t kMostGroups = 65535;
    const std::uint64_t rows = (groups + kMostGroups - 1) / kMostGroups;
    c.commands().dispatch(static_cast<std::uint32_t>(std::min(groups, kMostGroups)),
                          static_cast<std::uint32_t>(rows));
}

struct Kernel {
    const char* name;
    std::span<const std::uint32_t> code;
    std::uint32_t group;  ///< invocations
    std::vector<std::uint32_t> constants{};
};

/// A compute pass over storage buffers, the first `read_only` of which are only read. The ids of
/// the others are brought up to date.
void add_kernel(graph::FrameGraph& graph, const Kernel& kernel, const BuildParams& params,
                std::uint64_t items, const std::vector<BufferId*>& buffers, std::size_t read_only) {
    // Which resource an id names does not change with its version.
    std::vector<BufferId> ids;
    for (const BufferId* buffer : buffers) ids.push_back(*buffer);
    graph.add_pass(
        kernel.name, kBuildGroup,
        [&](PassBuilder& b) {
            for (std::size_t i = 0; i < buffers.size(); ++i) {
                if (i < read_only) {
                    b.read(*buffers[i], Use::compute_read);
                } else {
                    *buffers[i] = b.write(*buffers[i], Use::compute_write);
                }
            }
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = kernel.name;
            desc.compute = kernel.code;
            desc.bindings.assign(ids.size(), Binding::storage);
            desc.push_bytes = sizeof(params);
            desc.constants = kernel.constants;
            const bool made =
                ids.size() == 2 ? c.bind(desc, {c.bound(ids[0]), c.bound(ids[1])})
                                : c.bind(desc, {c.bound(ids[0]), c.bound(ids[1]), c.bound(ids[2])});
            if (!made) return;
            c.commands().constants(params);
            dispatch_groups(c, items, kernel.group);
        });
}

}  // namespace

Result<void> DeviceBvh::make_room(std::size_t triangles, int levels) {
    const auto fit = [&](gpu::Buffer& buffer, const char* name,
                         std::uint64_t bytes) -> Result<void> {
        if (!buffer.empty() && buffer.bytes() == bytes) return {};
        buffer = gpu::Buffer();
        KINO_ASSIGN(buffer, gpu::Buffer::create(device_, name, bytes, gpu::MemoryUse::upload));
        return {};
    };
    count_ = static_cast<std::uint32_t>(triangles);
    levels_ = triangles == 0 ? 0 : levels;
    if (triangles == 0) {
        clear();
        return {};
    }
    KINO_TRY(fit(nodes_, "bvh nodes", sizeof(shared::BvhNode) << levels));
    return fit(triangles_, "bvh triangles", sizeof(shared::BvhTriangle) * triangles);
}

Result<void> DeviceBvh::upload(const Bvh& bvh) {
    soup_ = gpu::Buffer();
    KINO_TRY(make_room(bvh.triangles.size(), bvh.levels));
    if (bvh.empty()) return {};
    nodes_.write(std::span<const shared::BvhNode>(bvh.nodes));
    triangles_.write(std::span<const shared::BvhTriangle>(bvh.triangles));
    return {};
}

Result<void> DeviceBvh::upload_soup(std::span<const Triangle> triangles,
                                    const BvhOptions& options) {
    KINO_CHECK(triangles.size() < (1u << 28) && options.leaf_triangles > 0);
    KINO_CHECK(options.levels >= 0 && options.levels <= kMostBvhLevels);
    options_ = options;
    KINO_TRY(make_room(triangles.size(),
                       options.levels > 0 ? options.levels : default_levels(triangles.size())));
    if (triangles.empty()) return {};
    if (soup_.empty() || soup_.bytes() != triangles.size_bytes()) {
        soup_ = gpu::Buffer();
        KINO_ASSIGN(soup_, gpu::Buffer::create(device_, "bvh soup", triangles.size_bytes(),
                                               gpu::MemoryUse::upload));
    }
    soup_.write(triangles);
    return {};
}

BuildParams DeviceBvh::params() const {
    return {.triangles = count_,
            .lanes = sort_lanes,
            .leaf_triangles = options_.leaf_triangles,
            .last_level = static_cast<std::uint32_t>(levels_ - 1)};
}

BvhBuffers DeviceBvh::add(graph::FrameGraph& graph) const {
    if (levels_ == 0) return {};
    return {.nodes = graph.import_buffer("bvh nodes", nodes_),
            .triangles = graph.import_buffer("bvh triangles", triangles_),
            .levels = levels_,
            .triangle_count = count_};
}

BvhBuffers DeviceBvh::add_build(graph::FrameGraph& graph) const {
    BvhBuffers bvh = add(graph);
    if (bvh.empty()) return bvh;
    KINO_CHECK(!soup_.empty());
    BuildParams p = params();
    BufferId soup = graph.import_buffer("bvh soup", soup_);
    BufferId keys = graph.create_buffer("bvh box", {6 * 4});
    BufferId frame = graph.create_buffer("bvh frame", {sizeof(shared::MortonFrame)});
    BufferId codes = graph.create_buffer("bvh codes", {std::uint64_t{count_} * 8});
    graph.add_pass(
        "accel/clear", kBuildGroup,
        [&](PassBuilder& b) { keys = b.write(keys, Use::transfer_write); },
        [id = keys](PassContext& c) { c.commands().fill(c.buffer(id), UINT32_MAX); });
    add_kernel(graph, {"accel/box", kBox, 8}, p, p.lanes, {&soup, &keys}, 1);
    add_kernel(graph,
               {"accel/frame", kFrame, 1, {options_.axes == AxisRule::longest_cell ? 1u : 0u}}, p,
               1, {&keys, &frame, &bvh.nodes}, 1);
    add_kernel(graph, {"accel/codes", kCodes, 64}, p, count_, {&soup, &frame, &codes}, 2);
    BufferId totals = graph.create_buffer("bvh digit totals", {256 * 4});
    BufferId counts = graph.create_buffer("bvh digit counts", {std::uint64_t{256} * p.lanes * 4});
    BufferId sorted = graph.create_buffer("bvh codes, sorted", {std::uint64_t{count_} * 8});
    for (p.shift = 0; p.shift < 32; p.shift += 8) {
        add_kernel(graph, {"accel/sort count", kSortCount, 8}, p, p.lanes, {&codes, &counts}, 1);
        add_kernel(graph, {"accel/sort totals", kSortTotals, 64}, p, 256, {&counts, &totals}, 1);
        graph.add_pass(
            "accel/sort offsets", kBuildGroup,
            [&](PassBuilder& b) {
                counts = b.write(counts, Use::compute_write);
                b.read(totals, Use::compute_read);
            },
            [p, counts, totals](PassContext& c) {
                gpu::PipelineDesc desc;
                desc.name = "accel/sort offsets";
                desc.compute = kSortOffsets;
                desc.bindings = {Binding::storage, Binding::storage};
                desc.push_bytes = sizeof(p);
                if (!c.bind(desc, {c.bound(counts), c.bound(totals)})) return;
                c.commands().constants(p);
                c.commands().dispatch(4);
            });
        add_kernel(graph, {"accel/sort scatter", kSortScatter, 8}, p, p.lanes,
                   {&codes, &counts, &sorted}, 1);
        std::swap(codes, sorted);
    }
    p.shift = 0;
    add_kernel(graph, {"accel/order", kOrder, 64, {0u}}, p, count_, {&soup, &codes, &bvh.triangles},
               2);
    for (p.level = 0; p.level <= p.last_level; ++p.level) {
        add_kernel(graph, {"accel/nodes", kNodes, 64}, p, std::uint64_t{1} << p.level,
                   {&codes, &frame, &bvh.nodes}, 2);
    }
    add_boxes(graph, bvh);
    return bvh;
}

BvhBuffers DeviceBvh::add_refit(graph::FrameGraph& graph) const {
    BvhBuffers bvh = add(graph);
    if (bvh.empty()) return bvh;
    KINO_CHECK(!soup_.empty());
    BufferId soup = graph.import_buffer("bvh soup", soup_);
    BufferId unused = soup;
    add_kernel(graph, {"accel/order", kOrder, 64, {1u}}, params(), count_,
               {&soup, &unused, &bvh.triangles}, 2);
    add_boxes(graph, bvh);
    return bvh;
}

void DeviceBvh::add_boxes(graph::FrameGraph& graph, BvhBuffers& bvh) const {
    BuildParams p = params();
    for (std::uint32_t level = p.last_level + 1; level-- > 0;) {
        p.level = level;
        add_kernel(graph, {"accel/boxes", kBoxes, 64}, p, std::uint64_t{1} << level,
                   {&bvh.triangles, &bvh.nodes}, 1);
    }
}

std::uint64_t DeviceBvh::bytes() const {
    return soup_.bytes() + nodes_.bytes() + triangles_.bytes();
}

void DeviceBvh::clear() {
    soup_ = gpu::Buffer();
    nodes_ = gpu::Buffer();
    triangles_ = gpu::Buffer();
    levels_ = 0;
    count_ = 0;
}

BufferId add_trace(graph::FrameGraph& graph, const BvhBuffers& bvh, BufferId rays,
                   std::uint32_t count, bool any) {
    KINO_CHECK(!bvh.empty() && count > 0);
    BufferId hits = graph.create_buffer("hits", {std::uint64_t{count} * sizeof(shared::TraceHit)});
    const BuildParams p{.triangles = count};
    graph.add_pass(
        "accel/trace", "accel trace",
        [&](PassBuilder& b) {
            b.read(bvh.nodes, Use::compute_read);
            b.read(bvh.triangles, Use::compute_read);
            b.read(rays, Use::compute_read);
            hits = b.write(hits, Use::compute_write);
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "accel/trace";
            desc.compute = kTrace;
            desc.bindings = {Binding::word_quads, Binding::word_quads, Binding::word_quads,
                             Binding::storage};
            desc.push_bytes = sizeof(p);
            desc.constants = {any ? 1u : 0u};
            if (!c.bind(desc, {c.bound(bvh.nodes), c.bound(bvh.triangles), c.bound(rays),
                               c.bound(hits)})) {
                return;
            }
            c.commands().constants(p);
            dispatch_groups(c, count, 64);
        });
    return hits;
}

}  // namespace kino
