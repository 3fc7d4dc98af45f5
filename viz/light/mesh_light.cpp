#include "viz/light/mesh_light.h"

#include <vector>

#include "base/check.h"

namespace kino {

MeshLight make_mesh_light(graph::FrameGraph& graph, const Scene& scene, const View& view,
                          const LightLists& lists) {
    const Projection& k = view.projection;
    MeshLight light{.lists = lists,
                    .materials = add_material_upload(graph, scene),
                    .params = {.k = {k.fx, k.fy, k.cx, k.cy},
                               .ambient = scene.ambient,
                               .globals = lists.global_count,
                               .locals = lists.local_count,
                               .tiles_x = lists.tiles_x,
                               .row_px = static_cast<std::uint32_t>(view.width)},
                    .color_mode = static_cast<std::uint32_t>(scene.color_mode)};
    if (lists.tile_px != 0) {
        light.params.tile_scale = {
            static_cast<float>(lists.width) / static_cast<float>(view.width),
            static_cast<float>(lists.height) / static_cast<float>(view.height)};
        light.params.tile_scale /= static_cast<float>(lists.tile_px);
    }
    return light;
}

void declare_mesh_light(graph::PassBuilder& builder, const MeshLight& light) {
    for (const graph::BufferId id :
         {light.lists.lights, light.lists.headers, light.lists.indices, light.shadow_masks,
          light.materials.materials, light.materials.lobes}) {
        if (id.valid()) builder.read(id, graph::Use::fragment_read);
    }
    for (const graph::TextureId id : {light.sample_z, light.pixel_z, light.pixel_light}) {
        if (id.valid()) builder.read(id, graph::Use::fragment_read);
    }
}

MeshShader mesh_light_shader(const MeshLight& light, const std::string& name,
                             std::span<const std::uint32_t> fragment) {
    using gpu::Binding;
    MeshShader shader;
    shader.name = name;
    shader.fragment = fragment;
    shader.bindings = {Binding::word_quads, Binding::word_pairs, Binding::words,
                       Binding::words,      Binding::word_quads, Binding::word_quads};
    if (light.sample_z.valid()) {
        shader.bindings.insert(shader.bindings.end(), 3, Binding::texture);
    }
    shader.constants = {
        light.lists.tile_px != 0 ? 1u : 0u,   light.lists.global_count > 0 ? 1u : 0u,
        light.lists.has_spots ? 1u : 0u,      light.lists.has_masks ? 1u : 0u,
        light.shadow_masks.valid() ? 1u : 0u, light.color_mode,
        light.materials.lobe_kinds,           1u};
    return shader;
}

bool record_mesh_light(graph::PassContext& context, const MeshList& list, const MeshLight& light,
                       const MeshShader& shader) {
    const gpu::Bound lights = context.bound(light.lists.lights);
    const bool has_lists = light.lists.tile_px != 0;
    // What is compiled out still wants something bound.
    std::vector<gpu::Bound> own = {
        lights,
        has_lists ? context.bound(light.lists.headers) : lights,
        has_lists ? context.bound(light.lists.indices) : lights,
        light.shadow_masks.valid() ? context.bound(light.shadow_masks) : lights,
        context.bound(light.materials.materials),
        context.bound(light.materials.lobes)};
    if (light.sample_z.valid()) {
        for (const graph::TextureId id : {light.sample_z, light.pixel_z, light.pixel_light}) {
            own.push_back(context.bound(id));
        }
    }
    return MeshDrawer::record(
        context, list, shader, own,
        std::as_bytes(std::span<const shared::ListShadeParams>(&light.params, 1)));
}

}  // namespace kino
