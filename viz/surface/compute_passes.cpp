#include <algorithm>
#include <array>

#include "viz/surface/depth_passes.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::BufferId;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;
using shared::SurfaceParams;

constexpr std::uint32_t kSplat[] = {
#include "splat_comp.inc"
};
constexpr std::uint32_t kSplat32[] = {
#include "splat32_comp.inc"
};
constexpr std::uint32_t kMeshCells[] = {
#include "mesh_cells_comp.inc"
};
constexpr std::uint32_t kMeshCells32[] = {
#include "mesh_cells32_comp.inc"
};
constexpr std::uint32_t kMeshLarge[] = {
#include "mesh_large_comp.inc"
};
constexpr std::uint32_t kMeshLarge32[] = {
#include "mesh_large32_comp.inc"
};
constexpr std::uint32_t kNormals[] = {
#include "normals_comp.inc"
};
constexpr std::uint32_t kFullscreen[] = {
#include "fullscreen_vert.inc"
};
constexpr std::uint32_t kResolveCloud[] = {
#include "resolve_cloud_frag.inc"
};
constexpr std::uint32_t kResolveMesh[] = {
#include "resolve_mesh_frag.inc"
};
constexpr std::uint32_t kResolveColor[] = {
#include "resolve_color_frag.inc"
};
constexpr std::uint32_t kResolveColor64[] = {
#include "resolve_color64_frag.inc"
};

constexpr const char* kRasterGroup = "raster";
constexpr const char* kResolveGroup = "resolve";

std::uint32_t groups_of_64(std::uint64_t items) {
    return static_cast<std::uint32_t>((items + 63) / 64);
}

std::uint64_t pixel_count(const SurfaceParams& p) {
    return std::uint64_t{p.target.x} * p.target.y;
}
std::uint64_t grid_count(const SurfaceParams& p) {
    return std::uint64_t{p.grid.x} * p.grid.y;
}

/// Bindings: 0 what is written, 1 .. 3 depth_inputs.glsl, 4 the large triangles. `pinhole` goes
/// where depth_grid.glsl has it, behind the shader's own constants.
gpu::PipelineDesc compute(const char* name, std::span<const std::uint32_t> code,
                          std::size_t bindings, bool pinhole,
                          std::vector<std::uint32_t> constants = {}) {
    constants.resize(kPinholeConstant, 0);
    constants.push_back(pinhole ? 1 : 0);
    gpu::PipelineDesc desc;
    desc.name = name;
    desc.compute = code;
    desc.bindings = {Binding::storage, Binding::words, Binding::word_pairs, Binding::words,
                     Binding::storage};
    desc.bindings.resize(bindings);
    desc.push_bytes = sizeof(SurfaceParams);
    desc.constants = std::move(constants);
    return desc;
}

/// Rows that nothing is drawn into are left as they are, and not read.
BufferId add_clear(graph::FrameGraph& graph, const DepthPassInputs& in) {
    BufferId visibility = graph.create_buffer("visibility", {pixel_count(in.params) * 8});
    const std::uint64_t row_bytes = std::uint64_t{in.params.target.x} * 8;
    // Holes are filled from a row farther off.
    constexpr std::uint32_t kReach = 2;
    const auto top = static_cast<std::uint32_t>(in.picture.offset.y);
    const std::uint32_t from = top - std::min(top, kReach);
    const std::uint32_t to = std::min(top + in.picture.extent.height + kReach, in.params.target.y);
    const std::uint64_t first = from * row_bytes;
    const std::uint64_t bytes = (to - from) * row_bytes;
    // Ids captured by a pass name the resource, not its version: what matters to execution.
    graph.add_pass(
        "surface/clear", kRasterGroup,
        [&](PassBuilder& b) { visibility = b.write(visibility, Use::transfer_write); },
        [=, id = visibility](PassContext& c) {
            c.commands().fill(c.buffer(id), first, bytes, UINT32_MAX);
        });
    return visibility;
}

/// Two passes with 32-bit keys (least depth, then least index), one with 64-bit keys.
template <class AddPass>
void for_each_key_pass(bool key32, SurfaceParams params, AddPass add_pass) {
    for (std::uint32_t key_pass = 0; key_pass < (key32 ? 2u : 1u); ++key_pass) {
        params.key_pass = key_pass;
        add_pass(params, key_pass == 1);
    }
}

/// One lane a depth pixel, in groups of 64 along rows.
void dispatch_pixels(PassContext& c, const DepthBounds& bounds) {
    const std::uint32_t first = bounds.x0 / 64;
    c.commands().dispatch_from(first, bounds.y0, groups_of_64(bounds.x1) - first,
                               bounds.y1 - bounds.y0);
}

/// Without normals and ids the keys carry colours, and the resolve is a copy.
bool carries_color(const SurfaceTargets& targets) {
    return !targets.normal.valid() && !targets.id.valid();
}

SurfaceTargets add_resolve(graph::FrameGraph& graph, const DepthPassInputs& in, BufferId visibility,
                           bool mesh, bool key32, SurfaceTargets targets) {
    const bool color_payload = carries_color(targets);
    const char* name = color_payload ? "surface/resolve colours"
                       : mesh        ? "surface/resolve mesh"
                                     : "surface/resolve cloud";
    const BufferId normals = in.normals.valid() ? in.normals : in.depth;
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = name;
        desc.vertex = kFullscreen;
        desc.fragment = color_payload ? (key32 ? std::span<const std::uint32_t>(kResolveColor)
                                               : std::span<const std::uint32_t>(kResolveColor64))
                        : mesh        ? std::span<const std::uint32_t>(kResolveMesh)
                                      : std::span<const std::uint32_t>(kResolveCloud);
        desc.bindings = {Binding::word_pairs, Binding::words, Binding::word_pairs, Binding::words,
                         Binding::storage};
        if (color_payload) desc.bindings.resize(1);
        desc.push_bytes = sizeof(SurfaceParams);
        desc.constants = {targets.normal.valid() ? 1u : 0u, in.has_color ? 1u : 0u,
                          in.params.fill_holes, color_payload && !key32 ? 1u : 0u};
        desc.color_formats = target_formats(c, targets);
        begin_targets(c, targets, false, nullptr);
        record_background_around(c, targets, in.params, in.picture);
        c.commands().scissor(in.picture);
        const bool bound =
            color_payload ? c.bind(desc, {c.bound(visibility)})
                          : c.bind(desc, {c.bound(visibility), c.bound(in.depth), c.bound(in.rays),
                                          c.bound(in.color), c.bound(normals)});
        if (bound) {
            c.commands().constants(in.params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        name, kResolveGroup,
        [&](PassBuilder& b) {
            b.read(visibility, Use::fragment_read);
            if (!color_payload) {
                for (const BufferId id : {in.depth, in.rays, in.color, normals}) {
                    b.read(id, Use::fragment_read);
                }
            }
            write_targets(b, targets);
        },
        execute);
    return targets;
}

}  // namespace

BufferId add_normals_pass(graph::FrameGraph& graph, const DepthPassInputs& in) {
    BufferId normals = graph.create_buffer("normals", {grid_count(in.params) * 4});
    graph.add_pass(
        "surface/normals", "normals",
        [&](PassBuilder& b) {
            b.read(in.depth, Use::compute_read);
            b.read(in.rays, Use::compute_read);
            normals = b.write(normals, Use::compute_write);
        },
        [in, normals](PassContext& c) {
            if (!c.bind(compute("surface/normals", kNormals, 3, in.pinhole),
                        {c.bound(normals), c.bound(in.depth), c.bound(in.rays)})) {
                return;
            }
            c.commands().constants(in.params);
            dispatch_pixels(c, in.bounds);
        });
    return normals;
}

SurfaceTargets add_compute_cloud(graph::FrameGraph& graph, const DepthPassInputs& in, bool key32,
                                 SurfaceTargets targets) {
    BufferId visibility = add_clear(graph, in);
    for_each_key_pass(key32, in.params, [&](const SurfaceParams& params, bool index_pass) {
        graph.add_pass(
            index_pass ? "surface/splat index" : "surface/splat", kRasterGroup,
            [&](PassBuilder& b) {
                b.read(in.depth, Use::compute_read);
                b.read(in.rays, Use::compute_read);
                b.read(in.color, Use::compute_read);
                visibility = b.write(visibility, Use::compute_write);
            },
            [=](PassContext& c) {
                const std::vector<std::uint32_t> constants = {carries_color(targets) ? 1u : 0u,
                                                              in.has_color ? 1u : 0u,
                                                              params.splat_cap_px == 1 ? 1u : 0u};
                const auto desc =
                    key32 ? compute("surface/splat 32 bit", kSplat32, 4, in.pinhole, constants)
                          : compute("surface/splat", kSplat, 4, in.pinhole, constants);
                if (!c.bind(desc, {c.bound(visibility), c.bound(in.depth), c.bound(in.rays),
                                   c.bound(in.color)})) {
                    return;
                }
                c.commands().constants(params);
                dispatch_pixels(c, in.bounds);
            });
    });
    return add_resolve(graph, in, visibility, false, key32, targets);
}

SurfaceTargets add_compute_mesh(graph::FrameGraph& graph, const DepthPassInputs& in, bool key32,
                                SurfaceTargets targets) {
    const std::uint64_t cells = std::uint64_t{in.params.grid.x - 1} * (in.params.grid.y - 1);
    const std::vector<std::uint32_t> constants = {carries_color(targets) ? 1u : 0u,
                                                  in.has_color ? 1u : 0u};
    BufferId visibility = add_clear(graph, in);
    // Room for every triangle, so that no view can overflow it.
    BufferId large =
        graph.create_buffer("large triangles", {sizeof(shared::LargeList) + 2 * cells * 4});
    for_each_key_pass(key32, in.params, [&](const SurfaceParams& params, bool index_pass) {
        graph.add_pass(
            "surface/clear list", kRasterGroup,
            [&](PassBuilder& b) { large = b.write(large, Use::transfer_write); },
            [=](PassContext& c) {
                constexpr std::array<std::uint32_t, 4> kEmptyList = {0, 0, 1, 0};
                c.commands().update(c.buffer(large), kEmptyList);
            });
        graph.add_pass(
            index_pass ? "surface/small triangles index" : "surface/small triangles", kRasterGroup,
            [&](PassBuilder& b) {
                b.read(in.depth, Use::compute_read);
                b.read(in.rays, Use::compute_read);
                b.read(in.color, Use::compute_read);
                visibility = b.write(visibility, Use::compute_write);
                large = b.write(large, Use::compute_write);
            },
            [=](PassContext& c) {
                const auto desc = key32 ? compute("surface/small triangles 32 bit", kMeshCells32, 5,
                                                  in.pinhole, constants)
                                        : compute("surface/small triangles", kMeshCells, 5,
                                                  in.pinhole, constants);
                if (!c.bind(desc, {c.bound(visibility), c.bound(in.depth), c.bound(in.rays),
                                   c.bound(in.color), c.bound(large)})) {
                    return;
                }
                c.commands().constants(params);
                // A thread walks down sixteen cells of a column.
                const DepthBounds& b = in.bounds;
                const std::uint32_t first_y = b.y0 / 16;
                c.commands().dispatch_from(b.x0 / 64, first_y, groups_of_64(b.x1) - b.x0 / 64,
                                           (b.y1 + 15) / 16 - first_y);
            });
        graph.add_pass(
            index_pass ? "surface/large triangles index" : "surface/large triangles", kRasterGroup,
            [&](PassBuilder& b) {
                b.read(in.depth, Use::compute_read);
                b.read(in.rays, Use::compute_read);
                b.read(in.color, Use::compute_read);
                b.read(large, Use::indirect_read);
                b.read(large, Use::compute_read);
                visibility = b.write(visibility, Use::compute_write);
            },
            [=](PassContext& c) {
                const auto desc = key32 ? compute("surface/large triangles 32 bit", kMeshLarge32, 5,
                                                  in.pinhole, constants)
                                        : compute("surface/large triangles", kMeshLarge, 5,
                                                  in.pinhole, constants);
                if (!c.bind(desc, {c.bound(visibility), c.bound(in.depth), c.bound(in.rays),
                                   c.bound(in.color), c.bound(large)})) {
                    return;
                }
                c.commands().constants(params);
                c.commands().dispatch_indirect(c.buffer(large), 0);
            });
    });
    return add_resolve(graph, in, visibility, true, key32, targets);
}

}  // namespace kino
