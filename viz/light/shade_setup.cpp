#include "viz/light/shade_setup.h"

#include "base/check.h"

namespace kino {

void ShadeSetup::read(graph::PassBuilder& b, graph::Use use) const {
    const SurfaceTargets& surface = inputs.surface;
    for (const graph::TextureId id :
         {surface.albedo, surface.view_z, surface.normal, surface.object}) {
        if (id.valid()) b.read(id, use);
    }
    const LightLists& lists = inputs.lists;
    for (const graph::BufferId id : {lists.lights, lists.headers, lists.indices,
                                     inputs.shadow_masks, materials.materials, materials.lobes}) {
        if (id.valid()) b.read(id, use);
    }
}

std::vector<gpu::Binding> ShadeSetup::bindings() {
    using gpu::Binding;
    return {Binding::texture,    Binding::texture, Binding::texture, Binding::word_quads,
            Binding::word_pairs, Binding::words,   Binding::words};
}

std::vector<gpu::Bound> ShadeSetup::bound(const graph::PassContext& c) const {
    const LightLists& lists = inputs.lists;
    const bool has_lists = lists.tile_px != 0;
    const gpu::Bound lights = c.bound(lists.lights);
    // What is compiled out still wants something bound.
    return {c.bound(inputs.surface.albedo),
            c.bound(inputs.surface.view_z),
            c.bound(inputs.surface.normal),
            lights,
            has_lists ? c.bound(lists.headers) : lights,
            has_lists ? c.bound(lists.indices) : lights,
            inputs.shadow_masks.valid() ? c.bound(inputs.shadow_masks) : lights};
}

void ShadeSetup::append_materials(const graph::PassContext& c, std::vector<gpu::Binding>& kinds,
                                  std::vector<gpu::Bound>& bound) const {
    if (!has_materials()) return;
    using gpu::Binding;
    kinds.insert(kinds.end(), {Binding::texture, Binding::word_quads, Binding::word_quads});
    bound.insert(bound.end(), {c.bound(inputs.surface.object), c.bound(materials.materials),
                               c.bound(materials.lobes)});
}

ShadeSetup make_shade_setup(graph::FrameGraph& graph, const Scene& scene, const View& view,
                            const ShadeInputs& inputs) {
    const SurfaceTargets& surface = inputs.surface;
    const LightLists& lists = inputs.lists;
    KINO_CHECK(surface.albedo.valid() && surface.view_z.valid() && surface.normal.valid());
    ShadeSetup setup{.inputs = inputs};
    if (setup.has_materials()) setup.materials = add_material_upload(graph, scene);
    const Projection& k = view.projection;
    setup.params = {.k = {k.fx, k.fy, k.cx, k.cy},
                    .ambient = scene.ambient,
                    .globals = lists.global_count,
                    .locals = lists.local_count,
                    .tiles_x = lists.tiles_x,
                    .row_px = static_cast<std::uint32_t>(view.width)};
    const bool has_lists = lists.tile_px != 0;
    if (has_lists) {
        setup.params.tile_scale = glm::vec2(lists.width, lists.height) /
                                  glm::vec2(view.width, view.height) /
                                  static_cast<float>(lists.tile_px);
    }
    setup.constants = {has_lists ? 1u : 0u,
                       lists.global_count > 0 ? 1u : 0u,
                       lists.has_spots ? 1u : 0u,
                       lists.has_masks ? 1u : 0u,
                       inputs.shadow_masks.valid() ? 1u : 0u,
                       setup.has_materials() ? static_cast<std::uint32_t>(scene.color_mode)
                                             : (scene.color_mode == ColorMode::relit ? 0u : 1u),
                       setup.materials.lobe_kinds,
                       inputs.emission ? 1u : 0u,
                       (inputs.lights_only ? 1u : 0u) | (inputs.onto.valid() ? 2u : 0u)};
    return setup;
}

}  // namespace kino
