#include "viz/light/blended_pass.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_passes.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"

namespace kino {
namespace {

constexpr std::uint32_t kBlended[] = {
#include "blended_frag.inc"
};

}  // namespace

bool wants_blended(const Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [&](const MeshNode& node) { return is_blended(scene, node); });
}

graph::TextureId add_blended_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                  const MeshDrawer& meshes, const LightLists& lists,
                                  graph::TextureId linear, graph::TextureId depth) {
    const MeshList list = meshes.prepare(graph, scene, view, {.filter = MeshFilter::blended});
    if (list.count == 0) return linear;
    const bool has_lists = lists.tile_px != 0;
    const Projection& k = view.projection;
    shared::ListShadeParams params{.k = {k.fx, k.fy, k.cx, k.cy},
                                   .ambient = scene.ambient,
                                   .globals = lists.global_count,
                                   .locals = lists.local_count,
                                   .tiles_x = lists.tiles_x,
                                   .row_px = static_cast<std::uint32_t>(view.width)};
    if (has_lists) {
        KINO_CHECK(lists.width == static_cast<std::uint32_t>(view.width) &&
                   lists.height == static_cast<std::uint32_t>(view.height));
        params.tile_scale = glm::vec2(1.0f / static_cast<float>(lists.tile_px));
    }
    const MaterialBuffers materials = add_material_upload(graph, scene);
    const auto execute = [=](graph::PassContext& c) {
        using gpu::Binding;
        MeshShader shader;
        shader.name = "light/blended";
        shader.fragment = kBlended;
        shader.bindings = {Binding::word_quads, Binding::word_pairs, Binding::words,
                           Binding::words,      Binding::word_quads, Binding::word_quads};
        shader.constants = {has_lists ? 1u : 0u,
                            lists.global_count > 0 ? 1u : 0u,
                            lists.has_spots ? 1u : 0u,
                            lists.has_masks ? 1u : 0u,
                            0u,
                            static_cast<std::uint32_t>(scene.color_mode),
                            materials.lobe_kinds,
                            1u};
        shader.color_formats = {kSceneLinearFormat};
        shader.depth_test = gpu::DepthTest::not_farther;
        shader.blend = gpu::Blend::alpha;
        const gpu::Bound lights = c.bound(lists.lights);
        const std::array<gpu::Bound, 6> own = {lights,
                                               has_lists ? c.bound(lists.headers) : lights,
                                               has_lists ? c.bound(lists.indices) : lights,
                                               lights,
                                               c.bound(materials.materials),
                                               c.bound(materials.lobes)};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        const gpu::Target depth_target{.view = c.view(depth)};
        c.commands().begin_rendering({c.desc(linear).width, c.desc(linear).height}, targets,
                                     &depth_target);
        (void)MeshDrawer::record(
            c, list, shader, own,
            std::as_bytes(std::span<const shared::ListShadeParams>(&params, 1)));
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/blended", "light",
        [&](graph::PassBuilder& b) {
            MeshDrawer::declare(b, list);
            for (const graph::BufferId id : {lists.lights, lists.headers, lists.indices,
                                             materials.materials, materials.lobes}) {
                if (id.valid()) b.read(id, graph::Use::fragment_read);
            }
            depth = b.write(depth, graph::Use::depth_attachment);
            linear = b.write(linear, graph::Use::color_attachment);
        },
        execute);
    return linear;
}

}  // namespace kino
