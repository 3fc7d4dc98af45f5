#include "viz/light/light_passes.h"

#include <array>
#include <vector>

#include "viz/light/light_records.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kLight[] = {
#include "light_frag.inc"
};
constexpr std::uint32_t kPoints[] = {
#include "points_comp.inc"
};
constexpr std::uint32_t kFinalEmission[] = {
#include "final_emission_frag.inc"
};
constexpr std::uint32_t kFinal[] = {
#include "final_frag.inc"
};

/// A binding needs a byte where there is no light; the count stays 0.
std::vector<shared::LightRecord> bindable(std::vector<shared::LightRecord> records) {
    if (records.empty()) records.emplace_back();
    return records;
}

}  // namespace

bool wants_light(const Scene& scene) {
    return scene.live.has_value() &&
           (scene.color_mode == ColorMode::relit ||
            (scene.color_mode == ColorMode::mixed && !scene.lights.empty()));
}

graph::TextureId add_light_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const SurfaceTargets& surface) {
    graph::TextureId linear = graph.create_texture(
        "scene, linear", {static_cast<std::uint32_t>(view.width),
                          static_cast<std::uint32_t>(view.height), kSceneLinearFormat});
    const Projection& k = view.projection;
    const auto found = lights_in_view(scene, view);
    const shared::LightParams params{.k = {k.fx, k.fy, k.cx, k.cy},
                                     .ambient = scene.ambient,
                                     .count = static_cast<std::uint32_t>(found.size()),
                                     .mixed = scene.color_mode == ColorMode::mixed ? 1u : 0u};
    const auto records = bindable(found);
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/shade";
        desc.vertex = kFullscreen;
        desc.fragment = kLight;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::texture, gpu::Binding::texture,
                         gpu::Binding::storage};
        desc.push_bytes = sizeof(params);
        desc.color_formats = {kSceneLinearFormat};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        c.commands().begin_rendering({c.desc(linear).width, c.desc(linear).height}, targets,
                                     nullptr);
        if (c.bind(desc, {c.bound(surface.albedo), c.bound(surface.view_z), c.bound(surface.normal),
                          c.upload(records)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/shade", "light",
        [&](PassBuilder& b) {
            b.read(surface.albedo, Use::fragment_read);
            b.read(surface.view_z, Use::fragment_read);
            b.read(surface.normal, Use::fragment_read);
            linear = b.write(linear, Use::color_attachment);
        },
        execute);
    return linear;
}

graph::BufferId add_point_light_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                     const DepthPassInputs& in) {
    const std::uint64_t points = std::uint64_t{in.params.grid.x} * in.params.grid.y;
    graph::BufferId lit = graph.create_buffer("lit colours", {points * 4});
    const auto found = lights_in_view(scene, view);
    const shared::PointLightParams params{.ambient = scene.ambient,
                                          .count = static_cast<std::uint32_t>(found.size()),
                                          .mixed = scene.color_mode == ColorMode::mixed ? 1u : 0u,
                                          .exposure = scene.exposure};
    const auto records = bindable(found);
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/points";
        desc.compute = kPoints;
        using gpu::Binding;
        desc.bindings = {Binding::storage, Binding::words,   Binding::word_pairs, Binding::words,
                         Binding::storage, Binding::storage, Binding::storage};
        desc.push_bytes = sizeof(in.params);
        desc.constants.assign(kPinholeConstant + 1, 0);
        desc.constants[1] = in.has_color ? 1 : 0;
        desc.constants[kPinholeConstant] = in.pinhole ? 1 : 0;
        if (!c.bind(desc,
                    {c.bound(lit), c.bound(in.depth), c.bound(in.rays), c.bound(in.color),
                     c.bound(in.normals), c.upload(&params, sizeof(params)), c.upload(records)})) {
            return;
        }
        c.commands().constants(in.params);
        c.commands().dispatch((in.params.grid.x + 63) / 64, in.params.grid.y);
    };
    graph.add_pass(
        "light/points", "light",
        [&](PassBuilder& b) {
            for (const graph::BufferId id : {in.depth, in.rays, in.color, in.normals}) {
                b.read(id, Use::compute_read);
            }
            lit = b.write(lit, Use::compute_write);
        },
        execute);
    return lit;
}

bool wants_tone_map(const Scene& scene) {
    return scene.color_mode != ColorMode::captured;
}

graph::TextureId add_final_pass(graph::FrameGraph& graph, const Scene& scene,
                                graph::TextureId scene_linear, graph::TextureId target,
                                graph::TextureId emitting) {
    const MaterialBuffers materials =
        emitting.valid() ? add_material_upload(graph, scene) : MaterialBuffers{};
    const shared::FinalParams params{.exposure = scene.exposure,
                                     .tone_map = wants_tone_map(scene) ? 1u : 0u};
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        const bool emits = emitting.valid();
        desc.name = emits ? "light/final with emission" : "light/final";
        desc.vertex = kFullscreen;
        desc.fragment = emits ? std::span<const std::uint32_t>(kFinalEmission)
                              : std::span<const std::uint32_t>(kFinal);
        desc.bindings = {gpu::Binding::texture};
        if (emits)
            desc.bindings = {gpu::Binding::texture, gpu::Binding::texture,
                             gpu::Binding::word_quads};
        desc.push_bytes = sizeof(params);
        desc.color_formats = {c.desc(target).format};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
        c.commands().begin_rendering({c.desc(target).width, c.desc(target).height}, targets,
                                     nullptr);
        if (emits ? c.bind(desc,
                           {c.bound(scene_linear), c.bound(emitting), c.bound(materials.materials)})
                  : c.bind(desc, {c.bound(scene_linear)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/final", "final",
        [&](PassBuilder& b) {
            b.read(scene_linear, Use::fragment_read);
            if (emitting.valid()) {
                b.read(emitting, Use::fragment_read);
                b.read(materials.materials, Use::fragment_read);
            }
            target = b.write(target, Use::color_attachment);
        },
        execute);
    return target;
}

}  // namespace kino
