#include <algorithm>
#include <array>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_passes.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kListsFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kShadeLive[] = {
#include "shade_live_frag.inc"
};
constexpr std::uint32_t kShadeMaterials[] = {
#include "shade_materials_frag.inc"
};

std::vector<gpu::Binding> bindings_of(bool with_materials) {
    using gpu::Binding;
    if (!with_materials) {
        return {Binding::texture,    Binding::texture, Binding::texture, Binding::word_quads,
                Binding::word_pairs, Binding::words,   Binding::words};
    }
    return {Binding::texture,    Binding::texture,   Binding::texture, Binding::word_quads,
            Binding::word_pairs, Binding::words,     Binding::words,   Binding::texture,
            Binding::word_quads, Binding::word_quads};
}

}  // namespace

graph::TextureId add_shade_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const ShadeInputs& inputs) {
    const SurfaceTargets& surface = inputs.surface;
    const LightLists& lists = inputs.lists;
    KINO_CHECK(surface.albedo.valid() && surface.view_z.valid() && surface.normal.valid());
    const bool has_materials = surface.object.valid();
    const bool has_lists = lists.tile_px != 0;
    const bool has_shadows = inputs.shadow_masks.valid();
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    graph::TextureId linear =
        graph.create_texture("scene, linear", {width, height, kSceneLinearFormat});
    const Projection& k = view.projection;
    shared::ListShadeParams params{.k = {k.fx, k.fy, k.cx, k.cy},
                                   .ambient = scene.ambient,
                                   .globals = lists.global_count,
                                   .locals = lists.local_count,
                                   .tiles_x = lists.tiles_x,
                                   .row_px = width};
    if (has_lists) {
        params.tile_scale = {static_cast<float>(lists.width) / static_cast<float>(width),
                             static_cast<float>(lists.height) / static_cast<float>(height)};
        params.tile_scale /= static_cast<float>(lists.tile_px);
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
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = has_materials ? "light/shade materials" : "light/shade live";
        desc.vertex = kListsFullscreen;
        desc.fragment = has_materials ? std::span<const std::uint32_t>(kShadeMaterials)
                                      : std::span<const std::uint32_t>(kShadeLive);
        desc.bindings = bindings_of(has_materials);
        desc.push_bytes = sizeof(params);
        desc.constants = constants;
        desc.color_formats = {kSceneLinearFormat};
        const gpu::Bound lights = c.bound(lists.lights);
        // What is compiled out still wants something bound.
        const gpu::Bound headers = has_lists ? c.bound(lists.headers) : lights;
        const gpu::Bound indices = has_lists ? c.bound(lists.indices) : lights;
        const gpu::Bound masks = has_shadows ? c.bound(inputs.shadow_masks) : lights;
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        c.commands().begin_rendering({width, height}, targets, nullptr);
        bool bound = false;
        if (has_materials) {
            bound = c.bind(
                desc, {c.bound(surface.albedo), c.bound(surface.view_z), c.bound(surface.normal),
                       lights, headers, indices, masks, c.bound(surface.object),
                       c.bound(materials.materials), c.bound(materials.lobes)});
        } else {
            bound = c.bind(desc, {c.bound(surface.albedo), c.bound(surface.view_z),
                                  c.bound(surface.normal), lights, headers, indices, masks});
        }
        if (bound) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/shade lists", "light",
        [&](PassBuilder& b) {
            for (const graph::TextureId id :
                 {surface.albedo, surface.view_z, surface.normal, surface.object}) {
                if (id.valid()) b.read(id, Use::fragment_read);
            }
            for (const graph::BufferId id :
                 {lists.lights, lists.headers, lists.indices, inputs.shadow_masks,
                  materials.materials, materials.lobes}) {
                if (id.valid()) b.read(id, Use::fragment_read);
            }
            linear = b.write(linear, Use::color_attachment);
        },
        execute);
    return linear;
}

}  // namespace kino
