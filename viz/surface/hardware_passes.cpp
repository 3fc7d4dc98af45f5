#include "viz/surface/depth_passes.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kPointsVertex[] = {
#include "hardware_points_vert.inc"
};
constexpr std::uint32_t kMeshVertex[] = {
#include "hardware_mesh_vert.inc"
};
constexpr std::uint32_t kMeshGeometry[] = {
#include "hardware_mesh_geom.inc"
};
constexpr std::uint32_t kFragment[] = {
#include "hardware_frag.inc"
};
constexpr std::uint32_t kBackgroundVertex[] = {
#include "fullscreen_vert.inc"
};
constexpr std::uint32_t kBackground[] = {
#include "background_frag.inc"
};

bool bind_background(PassContext& c, const SurfaceTargets& targets,
                     const shared::SurfaceParams& params) {
    gpu::PipelineDesc desc;
    desc.name = "surface/background";
    desc.vertex = kBackgroundVertex;
    desc.fragment = kBackground;
    desc.push_bytes = sizeof(params);
    desc.color_formats = target_formats(c, targets);
    if (!c.bind(desc, {})) return false;
    c.commands().constants(params);
    return true;
}

/// Fills the targets with "nothing there": the gradient, and no depth, normal or id.
void draw_background(PassContext& c, const SurfaceTargets& targets,
                     const shared::SurfaceParams& params) {
    begin_targets(c, targets, false, nullptr);
    if (bind_background(c, targets, params)) c.commands().draw(3);
    c.commands().end_rendering();
}

/// `indices` valid: the grid as triangles through the geometry shader; else points.
SurfaceTargets add_hardware(graph::FrameGraph& graph, const DepthPassInputs& in, BufferId indices,
                            SurfaceTargets targets) {
    const bool mesh = indices.valid();
    const BufferId normals = in.normals.valid() ? in.normals : in.depth;
    graph::TextureId depth = graph.create_texture(
        "hardware depth", {in.params.target.x, in.params.target.y, VK_FORMAT_D32_SFLOAT});
    const auto execute = [=](PassContext& c) {
        draw_background(c, targets, in.params);
        c.commands().full_barrier();
        gpu::PipelineDesc desc;
        desc.name = mesh ? "surface/hardware mesh" : "surface/hardware points";
        desc.vertex = mesh ? std::span<const std::uint32_t>(kMeshVertex)
                           : std::span<const std::uint32_t>(kPointsVertex);
        if (mesh) desc.geometry = kMeshGeometry;
        desc.fragment = kFragment;
        desc.topology =
            mesh ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST : VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
        desc.bindings.assign(4, gpu::Binding::storage);
        desc.push_bytes = sizeof(shared::SurfaceParams);
        desc.constants = {targets.normal.valid() ? 1u : 0u, in.has_color ? 1u : 0u};
        desc.color_formats = target_formats(c, targets);
        desc.depth_format = VK_FORMAT_D32_SFLOAT;
        const gpu::Target depth_target{.view = c.view(depth), .clear = true};
        begin_targets(c, targets, false, &depth_target);
        if (c.bind(desc,
                   {c.bound(in.depth), c.bound(in.rays), c.bound(in.color), c.bound(normals)})) {
            c.commands().constants(in.params);
            if (mesh) {
                c.commands().draw_indexed(c.buffer(indices),
                                          6 * (in.params.grid.x - 1) * (in.params.grid.y - 1));
            } else {
                c.commands().draw(in.params.grid.x * in.params.grid.y);
            }
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        mesh ? "surface/hardware mesh" : "surface/hardware points", "raster",
        [&](PassBuilder& b) {
            for (const BufferId id : {in.depth, in.rays, in.color, normals}) {
                b.read(id, Use::vertex_read);
            }
            if (mesh) b.read(indices, Use::index_read);
            depth = b.write(depth, Use::depth_attachment);
            write_targets(b, targets);
        },
        execute);
    return targets;
}

}  // namespace

void record_background_around(PassContext& c, const SurfaceTargets& targets,
                              const shared::SurfaceParams& params, VkRect2D rect) {
    const std::uint32_t left = static_cast<std::uint32_t>(rect.offset.x);
    const std::uint32_t top = static_cast<std::uint32_t>(rect.offset.y);
    const std::uint32_t right = left + rect.extent.width;
    const std::uint32_t bottom = top + rect.extent.height;
    const std::array<VkRect2D, 4> strips = {
        VkRect2D{{0, 0}, {params.target.x, top}},
        VkRect2D{{0, static_cast<std::int32_t>(bottom)},
                 {params.target.x, params.target.y - bottom}},
        VkRect2D{{0, rect.offset.y}, {left, rect.extent.height}},
        VkRect2D{{static_cast<std::int32_t>(right), rect.offset.y},
                 {params.target.x - right, rect.extent.height}}};
    bool bound = false;
    for (const VkRect2D& strip : strips) {
        if (strip.extent.width == 0 || strip.extent.height == 0) continue;
        if (!bound && !bind_background(c, targets, params)) return;
        bound = true;
        c.commands().scissor(strip);
        c.commands().draw(3);
    }
}

SurfaceTargets add_background(graph::FrameGraph& graph, SurfaceTargets targets, std::uint32_t top,
                              std::uint32_t bottom) {
    graph.add_pass(
        "surface/background", "raster", [&](PassBuilder& b) { write_targets(b, targets); },
        [=](PassContext& c) {
            const graph::TextureDesc desc = c.desc(targets.albedo);
            shared::SurfaceParams params{};
            params.target = {desc.width, desc.height};
            params.background = {top, bottom};
            draw_background(c, targets, params);
        });
    return targets;
}

SurfaceTargets add_hardware_points(graph::FrameGraph& graph, const DepthPassInputs& inputs,
                                   SurfaceTargets targets) {
    return add_hardware(graph, inputs, {}, targets);
}

SurfaceTargets add_hardware_mesh(graph::FrameGraph& graph, const DepthPassInputs& inputs,
                                 graph::BufferId indices, SurfaceTargets targets) {
    return add_hardware(graph, inputs, indices, targets);
}

}  // namespace kino
