#include "viz/light/shade_list.h"

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kShadeListLive[] = {
#include "shade_list_live_comp.inc"
};
constexpr std::uint32_t kShadeListMaterials[] = {
#include "shade_list_materials_comp.inc"
};

}  // namespace

graph::TextureId add_shade_list(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const ShadeInputs& inputs, const PixelList& list,
                                graph::TextureId linear) {
    const SurfaceTargets& surface = inputs.surface;
    const LightLists& lists = inputs.lists;
    KINO_CHECK(surface.albedo.valid() && surface.view_z.valid() && surface.normal.valid());
    const bool has_materials = surface.object.valid();
    const bool has_lists = lists.tile_px != 0;
    const bool has_shadows = inputs.shadow_masks.valid();
    const Projection& k = view.projection;
    shared::ListShadeParams params{.k = {k.fx, k.fy, k.cx, k.cy},
                                   .ambient = scene.ambient,
                                   .globals = lists.global_count,
                                   .locals = lists.local_count,
                                   .tiles_x = lists.tiles_x,
                                   .row_px = 0};
    if (has_lists) {
        params.tile_scale = glm::vec2(lists.width, lists.height) /
                            glm::vec2(view.width, view.height) / static_cast<float>(lists.tile_px);
    }
    MaterialBuffers materials;
    if (has_materials) materials = add_material_upload(graph, scene);
    const std::vector<std::uint32_t> constants = {
        has_lists ? 1u : 0u,
        lists.global_count > 0 ? 1u : 0u,
        lists.has_spots ? 1u : 0u,
        lists.has_masks ? 1u : 0u,
        has_shadows ? 1u : 0u,
        has_materials ? static_cast<std::uint32_t>(scene.color_mode)
                      : (scene.color_mode == ColorMode::relit ? 0u : 1u),
        materials.lobe_kinds,
        inputs.emission ? 1u : 0u};
    const auto execute = [=, target = linear](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = has_materials ? "light/shade listed materials" : "light/shade listed live";
        desc.compute = has_materials ? std::span<const std::uint32_t>(kShadeListMaterials)
                                     : std::span<const std::uint32_t>(kShadeListLive);
        desc.bindings = {Binding::texture,    Binding::texture,    Binding::texture,
                         Binding::word_quads, Binding::word_pairs, Binding::words,
                         Binding::words,      Binding::words,      Binding::words,
                         Binding::image};
        desc.push_bytes = sizeof(params);
        desc.constants = constants;
        const gpu::Bound lights = c.bound(lists.lights);
        // What is compiled out still wants something bound.
        std::vector<gpu::Bound> bound = {c.bound(surface.albedo),
                                         c.bound(surface.view_z),
                                         c.bound(surface.normal),
                                         lights,
                                         has_lists ? c.bound(lists.headers) : lights,
                                         has_lists ? c.bound(lists.indices) : lights,
                                         has_shadows ? c.bound(inputs.shadow_masks) : lights,
                                         c.bound(list.pixels),
                                         c.bound(list.dispatch),
                                         c.bound(target)};
        if (has_materials) {
            desc.bindings.insert(desc.bindings.end(),
                                 {Binding::texture, Binding::word_quads, Binding::word_quads});
            bound.insert(bound.end(), {c.bound(surface.object), c.bound(materials.materials),
                                       c.bound(materials.lobes)});
        }
        if (!c.bind(desc, bound)) return;
        c.commands().constants(params);
        c.commands().dispatch_indirect(c.buffer(list.dispatch), 0);
    };
    graph.add_pass(
        "light/shade listed", "light",
        [&](PassBuilder& b) {
            for (const graph::TextureId id :
                 {surface.albedo, surface.view_z, surface.normal, surface.object}) {
                if (id.valid()) b.read(id, Use::compute_read);
            }
            for (const graph::BufferId id :
                 {lists.lights, lists.headers, lists.indices, inputs.shadow_masks,
                  materials.materials, materials.lobes, list.pixels, list.dispatch}) {
                if (id.valid()) b.read(id, Use::compute_read);
            }
            b.read(list.dispatch, Use::indirect_read);
            linear = b.write(linear, Use::compute_write);
        },
        execute);
    return linear;
}

}  // namespace kino
