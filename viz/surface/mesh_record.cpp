#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "base/check.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kPullVertex[] = {
#include "mesh_pull_vert.inc"
};
constexpr std::uint32_t kPullAttributeVertex[] = {
#include "mesh_pull_attribute_vert.inc"
};
constexpr std::uint32_t kFixedVertex[] = {
#include "mesh_fixed_vert.inc"
};
constexpr std::uint32_t kSurfaceFragment[] = {
#include "mesh_surface_frag.inc"
};
constexpr std::uint32_t kPlainFragment[] = {
#include "mesh_surface_plain_frag.inc"
};
constexpr std::uint32_t kSeedVertex[] = {
#include "fullscreen_vert.inc"
};
constexpr std::uint32_t kSeedFragment[] = {
#include "mesh_depth_seed_frag.inc"
};

std::uint32_t carrier_of(const MeshList& list) {
    switch (list.options.carrier) {
        case DrawIdCarrier::draw_id:
            return KINO_CARRIER_DRAW_ID;
        case DrawIdCarrier::instance:
            return KINO_CARRIER_INSTANCE;
        case DrawIdCarrier::pushed:
            return KINO_CARRIER_PUSHED;
        case DrawIdCarrier::first_instance:
        case DrawIdCarrier::attribute:
            break;
    }
    return KINO_CARRIER_FIRST_INSTANCE;
}

gpu::PipelineDesc describe(const MeshList& list, const MeshShader& shader) {
    gpu::PipelineDesc desc;
    desc.name = shader.name;
    desc.vertex = kPullVertex;
    desc.fragment = shader.fragment;
    desc.bindings = {gpu::Binding::word_quads, gpu::Binding::word_quads, gpu::Binding::word_quads,
                     gpu::Binding::words, gpu::Binding::words};
    desc.bindings.insert(desc.bindings.end(), shader.bindings.begin(), shader.bindings.end());
    desc.constants = {list.formats, carrier_of(list), list.textured ? 1u : 0u};
    desc.constants.insert(desc.constants.end(), shader.constants.begin(), shader.constants.end());
    desc.color_formats = shader.color_formats;
    desc.depth_format = shader.depth_format;
    desc.depth_test = shader.depth_test;
    desc.blend = shader.blend;
    desc.samples = shader.samples;
    if (list.options.submit == MeshSubmit::fixed_function) {
        desc.name += " fixed";
        desc.vertex = kFixedVertex;
        desc.streams = {
            {.stride = 32,
             .attributes = {{VK_FORMAT_R32G32B32_SFLOAT, 0}, {VK_FORMAT_R32G32B32_SFLOAT, 12}}},
            {.stride = 32, .attributes = {{VK_FORMAT_R32G32_SFLOAT, 24}}}};
    } else if (list.options.carrier == DrawIdCarrier::attribute) {
        desc.name += " by attribute";
        desc.vertex = kPullAttributeVertex;
        desc.streams = {
            {.stride = 4, .per_instance = true, .attributes = {{VK_FORMAT_R32_UINT, 0}}}};
    }
    return desc;
}

/// The rival's way: buffers and offsets set for every draw that needs others than the last.
void record_fixed(PassContext& context, const MeshList& list) {
    gpu::Commands& commands = context.commands();
    const VkBuffer still = context.buffer(list.vertices);
    const VkBuffer skinned = context.buffer(list.skinned);
    VkBuffer bound = VK_NULL_HANDLE;
    std::uint64_t bound_offset = UINT64_MAX;
    for (const VkDrawIndexedIndirectCommand& call : *list.calls) {
        const shared::MeshDraw& draw = (*list.host_rows)[call.firstInstance];
        const std::uint32_t first = draw.id & ((1u << KINO_FIRST_VERTEX_BITS) - 1);
        const bool moves = draw.id >> KINO_FIRST_VERTEX_BITS == KINO_FORMAT_SKINNED;
        // Both streams share one vertex offset, so what differs goes into the binding.
        const VkBuffer moving = moves ? skinned : still;
        const std::uint64_t offset = moves ? std::uint64_t{draw.static_first} * 32 : 0;
        if (moving != bound || offset != bound_offset) {
            const std::array<VkBuffer, 2> buffers = {moving, still};
            const std::array<VkDeviceSize, 2> offsets = {moves ? std::uint64_t{first} * 32 : 0,
                                                         offset};
            vkCmdBindVertexBuffers(commands.handle(), 0, 2, buffers.data(), offsets.data());
            bound = moving;
            bound_offset = offset;
        }
        VkDrawIndexedIndirectCommand shifted = call;
        shifted.vertexOffset = moves ? 0 : static_cast<std::int32_t>(first);
        commands.draw_indexed(shifted);
    }
}

}  // namespace

void MeshDrawer::declare(PassBuilder& builder, const MeshList& list) {
    if (list.count == 0) return;
    const bool fixed = list.options.submit == MeshSubmit::fixed_function;
    auto read_once = [&, seen = std::vector<std::uint32_t>()](BufferId id, Use use) mutable {
        for (const std::uint32_t index : seen) {
            if (index == id.index) return;
        }
        seen.push_back(id.index);
        builder.read(id, use);
    };
    builder.read(list.indices, Use::index_read);
    if (fixed) {
        builder.read(list.vertices, Use::attribute_read);
        if (list.skinned.index != list.vertices.index) {
            builder.read(list.skinned, Use::attribute_read);
        }
    }
    for (const BufferId id : {list.rows, list.vertices, list.skinned}) {
        read_once(id, Use::vertex_read);
    }
    if (list.options.carrier == DrawIdCarrier::attribute) {
        builder.read(list.row_of_draw, Use::attribute_read);
    } else {
        read_once(list.row_of_draw, Use::vertex_read);
    }
    if (list.textured) builder.read(list.texels, Use::fragment_read);
    if (list.commands.valid()) builder.read(list.commands, Use::indirect_read);
    if (list.counters.valid()) builder.read(list.counters, Use::indirect_read);
}

bool MeshDrawer::record(PassContext& context, const MeshList& list, const MeshShader& shader,
                        std::span<const gpu::Bound> own, std::span<const std::byte> own_constants) {
    KINO_CHECK(list.count > 0);
    KINO_CHECK_EQ(own.size(), shader.bindings.size());
    gpu::PipelineDesc desc = describe(list, shader);
    desc.push_bytes = kMeshPushBytes + static_cast<std::uint32_t>(own_constants.size());
    std::vector<gpu::Bound> resources = {
        context.bound(list.rows), context.bound(list.vertices), context.bound(list.skinned),
        context.bound(list.row_of_draw), context.bound(list.texels)};
    resources.insert(resources.end(), own.begin(), own.end());
    if (!context.bind(desc, resources)) return false;
    gpu::Commands& commands = context.commands();
    std::vector<std::byte> push(desc.push_bytes);
    std::memcpy(push.data(), &list.view, kMeshPushBytes);
    std::copy(own_constants.begin(), own_constants.end(), push.begin() + kMeshPushBytes);
    commands.constants(std::span<const std::byte>(push));
    commands.index_buffer(context.buffer(list.indices));
    if (list.options.carrier == DrawIdCarrier::attribute) {
        const std::array<VkBuffer, 1> buffers = {context.buffer(list.row_of_draw)};
        commands.vertex_buffers(buffers);
    }
    switch (list.options.submit) {
        case MeshSubmit::fixed_function:
            record_fixed(context, list);
            break;
        case MeshSubmit::one_call_each:
            for (const VkDrawIndexedIndirectCommand& call : *list.calls) {
                if (list.options.carrier == DrawIdCarrier::pushed) {
                    shared::MeshView numbered = list.view;
                    numbered.first_row = call.firstInstance;
                    std::memcpy(push.data(), &numbered, kMeshPushBytes);
                    commands.constants(std::span<const std::byte>(push));
                }
                commands.draw_indexed(call);
            }
            break;
        case MeshSubmit::multi_draw:
            if (list.options.carrier == DrawIdCarrier::instance) {
                VkDrawIndexedIndirectCommand all = list.calls->front();
                all.instanceCount = list.count;
                commands.draw_indexed(all);
            } else if (!list.counters.valid()) {
                commands.draw_indexed_indirect(context.buffer(list.commands),
                                               static_cast<std::uint32_t>(list.calls->size()));
            } else if (list.options.culling == MeshCulling::compact) {
                const std::uint32_t most = list.options.capacity > 0
                                               ? std::min(list.options.capacity, list.count)
                                               : list.count;
                commands.draw_indexed_indirect_count(context.buffer(list.commands),
                                                     context.buffer(list.counters), most);
            } else {
                commands.draw_indexed_indirect(context.buffer(list.commands), list.count);
            }
            break;
    }
    return true;
}

MeshDrawer::Drawn MeshDrawer::add(FrameGraph& graph, const MeshList& list, SurfaceTargets targets,
                                  TextureId depth) const {
    if (list.count == 0) return {targets, depth};
    const auto ids_of = [](SurfaceTargets& t) {
        return std::array<TextureId*, 5>{&t.albedo, &t.view_z, &t.normal, &t.id, &t.object};
    };
    const auto execute = [list, targets, depth, ids_of](PassContext& c) mutable {
        MeshShader shader;
        const bool with_id = targets.id.valid();
        shader.name = with_id ? "meshes/draw" : "meshes/draw without id";
        shader.fragment = with_id ? std::span<const std::uint32_t>(kSurfaceFragment)
                                  : std::span<const std::uint32_t>(kPlainFragment);
        std::vector<gpu::Target> colors;
        for (const TextureId* id : ids_of(targets)) {
            if (id == &targets.id && !with_id) continue;
            shader.color_formats.push_back(id->valid() ? c.desc(*id).format : VK_FORMAT_UNDEFINED);
            colors.push_back({.view = id->valid() ? c.view(*id) : VK_NULL_HANDLE});
        }
        while (!colors.empty() && colors.back().view == VK_NULL_HANDLE) {
            colors.pop_back();
            shader.color_formats.pop_back();
        }
        const gpu::Target depth_target{.view = c.view(depth)};
        const graph::TextureDesc size = c.desc(depth);
        c.commands().begin_rendering({size.width, size.height}, colors, &depth_target);
        (void)record(c, list, shader);  // a pipeline that cannot be made fails the frame
        c.commands().end_rendering();
    };
    graph.add_pass(
        "meshes/draw", "meshes",
        [&](PassBuilder& b) {
            declare(b, list);
            for (TextureId* id : ids_of(targets)) {
                if (id->valid()) *id = b.write(*id, Use::color_attachment);
            }
            depth = b.write(depth, Use::depth_attachment);
        },
        execute);
    return {targets, depth};
}

TextureId add_depth_seed(FrameGraph& graph, const View& view, TextureId view_z, TextureId depth,
                         VkRect2D within) {
    TextureId made;
    graph.add_pass(
        "meshes/seed depth", "meshes",
        [&](PassBuilder& b) {
            b.read(view_z, Use::fragment_read);
            made = b.write(depth, Use::depth_attachment);
        },
        [view_z, depth, within,
         near_m = static_cast<float>(view.projection.near_m)](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "meshes/seed depth";
            desc.vertex = kSeedVertex;
            desc.fragment = kSeedFragment;
            desc.bindings = {gpu::Binding::texture};
            desc.push_bytes = kMeshPushBytes;
            desc.depth_format = kDepthFormat;
            desc.depth_test = gpu::DepthTest::any_writes;
            const gpu::Target target{.view = c.view(depth), .clear = true};
            const graph::TextureDesc size = c.desc(depth);
            desc.samples = size.samples;
            c.commands().begin_rendering({size.width, size.height}, {}, &target);
            if (c.bind(desc, {c.bound(view_z)})) {
                c.commands().constants(shared::MeshView{.near_m = near_m});
                if (within.extent.width > 0) c.commands().scissor(within);
                c.commands().draw(3);
            }
            c.commands().end_rendering();
        });
    return made;
}

}  // namespace kino
